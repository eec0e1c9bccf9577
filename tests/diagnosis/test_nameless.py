"""A gap without any effect worth a fit: parameters beyond their spread explain it, or nothing that is known does."""

import pytest

from diagnosis import decisions
from diagnosis.decide.weighing import weigh
from diagnosis.fit.evidence import FittedHypothesis

NOMINAL = FittedHypothesis((), None, 100.0)  # type: ignore[arg-type]


def test_parameters_alone_are_told_as_that() -> None:
    # Truth: a re-tune 60 nats better, and forms that gain no more than the plant's own noise leaves them.
    found = weigh([NOMINAL], NOMINAL, {}, left=5.0, retune=160.0 + decisions.RETUNE_COST)
    assert found.retune > 0.99
    assert found.unknown == pytest.approx(1.0 - found.retune)


@pytest.mark.parametrize(("left", "retune"), [(5.0, None), (4000.0, 100.0 + decisions.RETUNE_COST)])
def test_what_no_re_tune_explains_is_unknown(left: float, retune: float | None) -> None:
    # Truth: either there is no such re-tune, or it gains nothing and forms go on gaining thousands of nats.
    found = weigh([NOMINAL], NOMINAL, {}, left=left, retune=retune)
    assert found.unknown > 0.95
    assert found.fitted == ()
