"""Which ends are fitted once more: those that may yet become the best, however many others were found."""

from collections.abc import Sequence

import pytest

from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from diagnosis.search import beam
from tests.diagnosis.arm import arm_case, arm_log, plain_linearisation


@pytest.mark.parametrize(
    ("evidences", "settled"),
    [
        # 3 % of a gap of 2000 nats are 60: an end that lacks 59 may yet become the best, one that lacks 61 not.
        ((2000.0, 1941.0, 1939.0, 500.0), {"best", "second"}),
        # Of a gap of 200 nats they are 6, less than the 25 by which ends differ plainly.
        ((200.0, 176.0, 174.0, 50.0), {"best", "second"}),
    ],
)
def test_ends_that_are_far_from_the_best_are_not_settled(
    monkeypatch: pytest.MonkeyPatch, evidences: Sequence[float], settled: set[str]
) -> None:
    plain = plain_linearisation().fit
    nominal = FittedHypothesis((), plain, 0.0)
    names = ("best", "second", "third", "last")
    found = {
        frozenset((name,)): FittedHypothesis((name,), plain, value)
        for name, value in zip(names, evidences, strict=True)
    }
    asked: set[str] = set()

    def once_more(_: Case, entry: FittedHypothesis) -> FittedHypothesis:
        asked.update(entry.effects)
        return entry

    for step in ("refined", "once_more", "with_own_events"):
        monkeypatch.setattr(beam, step, once_more)
    monkeypatch.setattr(beam, "is_certain", lambda entry, found: True)
    monkeypatch.setattr(beam, "is_twin", lambda case, entry, best: True)
    monkeypatch.setattr(beam, "with_noise_beside", lambda case, entries, nominal: [])
    beam._settle(arm_case(arm_log(seed=47)), found, nominal)
    assert asked == settled
