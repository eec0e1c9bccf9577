"""What a verification fails for: cost against the sample period among it."""

import pytest

from records.verification import RoundingBound, TargetCost, Verification


@pytest.mark.parametrize(("bound", "budget", "fits"), [(900, 900, True), (901, 900, False), (799, 900, False)])
def test_a_step_that_may_outlast_its_sample_period_does_not_pass(bound: int, budget: int, fits: bool) -> None:
    cost = TargetCost("float32", 700, 800, bound, 100, 1000, 100, cycles_budget=budget)
    found = Verification("00", (), (), RoundingBound({}, "none"), (), (cost,))
    assert (cost.fits, found.passed) == (fits, fits)
    assert fits or str(bound) in found.failures[0]
