"""The instantaneous linearisation: in float32 it finds what the design stage finds in double precision, at every elevation."""

from dataclasses import replace

import numpy as np
import pytest

from controllers.instantaneous import CONTROLLER
from design.settings import read_settings
from records.errors import BadInput
from records.table import AXES
from sim.loop import fly
from sim.manoeuvres import hop
from tests.controllers.rows import ce150, designed
from tests.plants import bound
from tests.soak import sampled
from verification.comparison.eq26 import closed, form_error, plain


@pytest.mark.parametrize("axis", sampled(AXES, keep=["elevation"]))
def test_float32_places_the_poles_where_they_are_wanted_at_every_elevation(axis: str) -> None:
    # Truth: python-control and eq (26) in double precision; 1e-6 of each coefficient, a few roundings, and 1e-3 rad/s of the slowest pole.
    settings = read_settings(ce150())
    error = form_error(ce150(), settings, axis, closed(designed("instantaneous")[1], axis))
    assert error.coefficients < 1e-6
    slowest_rad_s = max(pole.real for pole in settings.axis(axis).poles_rad_s)
    assert (error.slowest_rad_s, error.fastest_rad_s) == pytest.approx((slowest_rad_s,) * 2, abs=1e-3)


@pytest.mark.parametrize("axis", sampled(AXES, keep=["elevation"]))
def test_the_plain_seven_equations_lose_their_poles_in_float32(axis: str) -> None:
    # Truth: with these poles the sum Q(1) is lost altogether and the loop is unstable at some elevation; why the closed form is there.
    error = form_error(ce150(), read_settings(ce150()), axis, plain(read_settings(ce150()), axis))
    assert error.q_sum > 1.0
    assert error.slowest_rad_s > 0.0


def test_it_flies_as_the_scheduled_law_does() -> None:
    # Truth: the fit of the schedule moves its poles by 5 % at most, so the two flights are within a degree of one another.
    flights = [
        fly(ce150(), designed(name)[0].float_law(designed(name)[1]), hop(ce150())).y
        for name in ("scheduled", "instantaneous")
    ]
    assert 0.0 < np.max(np.abs(flights[0] - flights[1])) < np.radians(1.0)


def test_another_free_degree_is_refused_with_its_name() -> None:
    settings = read_settings(ce150())
    other = settings.with_axis("azimuth", free_degree="q3_zero")
    with pytest.raises(BadInput, match=r"design\.azimuth.*q3_zero.*scheduled"):
        CONTROLLER.design(ce150(), other)


def test_a_sample_period_at_which_it_would_rectify_encoder_steps_is_refused() -> None:
    with pytest.raises(BadInput, match=r"sample_period_s: sample period: got 0\.001 s.*scheduled"):
        CONTROLLER.design(ce150(), replace(read_settings(ce150()), sample_period_s=0.001))


def test_equations_that_are_not_those_of_the_paper_s_model_are_refused() -> None:
    # Truth: the literal equations divide (9) by J_A alone, so their azimuth's damping does not grow with 1/cos.
    literal = bound("ce150_seed_literal")
    with pytest.raises(BadInput, match=r"azimuth at psi.*\(4\)-\(9\).*scheduled"):
        CONTROLLER.design(literal, read_settings(literal))
