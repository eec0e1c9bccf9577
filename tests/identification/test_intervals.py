"""Intervals of what is estimated: they end where a parameter's sign ends, all others are value and reach."""

import numpy as np
import pytest

from identification.fit.belief import Belief
from identification.results.result import NORMAL, Identification, Matched, identification, interval, signs_of
from tests.plants import bound

SHARE = 0.25  # of a value is its sd: poor, and yet told


def found(**sd: float) -> Identification:
    """The aeroshield with these coefficients as stated, each known to so much."""
    rig = bound("aeroshield")
    plant = rig.plant
    values = np.array([plant.parameters[name].value for name in sd])
    began = dict(zip(sd, values.tolist(), strict=True))
    belief = Belief(tuple(sd), values, np.diag(np.square(list(sd.values()))))
    return identification(plant, (), belief, signs=signs_of(rig.model), matched=Matched(began))


def test_an_interval_of_a_positive_parameter_is_one_of_factors_and_ends_above_zero() -> None:
    # Truth: of ln K the sd is SHARE, so both ends are K e^(-+1.96 SHARE); of c, which may be 0, they are c -+ 1.96 sd.
    stated = bound("aeroshield").plant.parameters
    K, c = stated["K"].value, stated["c"].value
    positive, other = found(K=SHARE * K, c=SHARE * c).estimates
    assert positive.lower == pytest.approx(K * np.exp(-NORMAL * SHARE))
    assert positive.upper == pytest.approx(K * np.exp(NORMAL * SHARE))
    assert (other.lower, other.upper) == pytest.approx((c - NORMAL * SHARE * c, c + NORMAL * SHARE * c))


def test_that_of_one_the_data_do_not_tell_ends_above_zero_too() -> None:
    # Truth: the file states K as 0.01 with an sd of 0.02, which reaches below zero; data that tell it to 1 add a hundredth of a per cent.
    (poor,) = found(K=1.0).estimates
    assert not poor.identified
    assert (poor.value, poor.sd) == pytest.approx((0.01, 1.0 / np.hypot(1.0 / 0.02, 1.0)))
    assert 0.0 < poor.lower < poor.value < poor.upper


def test_that_of_a_friction_ends_at_zero() -> None:
    # Truth: a dry friction of 0.2 mN m, sd 0.15 mN m, whose usual interval is -0.094 to 0.494 mN m.
    assert interval(0.2, NORMAL * 0.15, "non-negative") == pytest.approx((0.0, 0.494))
    assert interval(0.2, NORMAL * 0.15)[0] == pytest.approx(-0.094)
    assert signs_of(bound("aeroshield").model)["c"] == "non-negative"


def test_where_little_is_open_both_are_the_same() -> None:
    # Truth: e^r = 1 + r to r^2 / 2.
    assert interval(2.0, 0.02, "positive") == pytest.approx((1.98, 2.02), abs=2.0 * 0.01**2)


def test_a_reach_beyond_all_bounds_is_still_a_number() -> None:
    lower, upper = interval(1e-3, 1e9, "positive")
    assert 0.0 < lower < upper < np.inf
