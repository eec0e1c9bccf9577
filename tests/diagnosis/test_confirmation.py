"""A name that was sought without noise with a memory is more than that noise, or none."""

from dataclasses import replace

import pytest

from diagnosis.confirmation import is_noise
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.nominal import plain_fit, with_memory_of
from diagnosis.hypothesis.case import Case
from diagnosis.search.beam import Search
from diagnosis.search.draughts import without_memory
from tests.diagnosis.arm import LONG_S, arm_case, arm_log
from tests.diagnosis.decide.test_consequence import explained, seen
from tests.diagnosis.nominal import nominal_fit

GUST = {"arm.gust": {"sigma": 3e-4, "T": 0.5}}  # a fourteenth of what the arm needs
RUB = {"arm.coulomb": {"b": 4e-4}}


def asked(case: Case, noisy: FittedHypothesis, name: FittedHypothesis) -> tuple[list[str], bool]:
    """The rules that had a say, and whether all is noise."""
    still = without_memory(case, noisy)
    assert still is not None
    found = Search((name, still), still, True, object(), ())  # type: ignore[arg-type]
    after, noise = is_noise(seen(case, noisy), seen(case, still), found)
    return [entry.rule for entry in after.decisions], noise


@pytest.mark.parametrize(("effects", "noise"), [({}, True), (RUB, False)], ids=["gust", "gust and rub"])
def test_a_name_that_beside_noise_is_no_more_than_noise_is_none(
    effects: dict[str, dict[str, float]], noise: bool
) -> None:
    # Truth: a torque that comes and goes, without and with dry friction beside it, which is what is named. A row ahead noise follows the
    # friction too: it shows over a second.
    case = arm_case(arm_log({**GUST, **effects}, seed=41, seconds=LONG_S))
    noisy = as_fitted(case, nominal_fit(case))
    assert "arm.gust" in noisy.fit.hypothesis.effects
    rubs = explained(case, as_fitted(case, plain_fit(case)), "arm.coulomb", {"b": 4e-4 if effects else 1e-6})
    beside = as_fitted(case, with_memory_of(case, rubs.fit, noisy.fit.hypothesis))
    rules, told = asked(case, noisy, beside)
    assert told is noise
    assert rules == ["more_than_noise", "foresees_more_than_noise"]


def test_where_a_name_was_sought_beside_the_noise_nothing_is_asked() -> None:
    case = arm_case(arm_log(GUST, seed=41, seconds=LONG_S))
    noisy = as_fitted(case, nominal_fit(case))
    found = Search((replace(noisy, effects=("arm.coulomb",)),), noisy, True, object(), ())  # type: ignore[arg-type]
    before = seen(case, noisy)
    assert is_noise(before, before, found) == (before, False)
