"""Truth: models whose elements are straight lines over speed."""

import numpy as np
import pytest

from identification.envelope.flights.conditions import IDENTIFIED, LEFT_OUT, Condition, condition_of
from identification.envelope.interpolation import GlobalModel, between, nearest
from identification.envelope.output_equation.outputs import Linear
from identification.envelope.state_equation.free_run import Model
from records.errors import BadInput


def model(at):
    speed = float(at.speed_kts)
    state = Model(np.full((8, 8), speed), np.full((8, 4), 2 * speed), 0.05)
    return GlobalModel(state, Linear(np.full((3, 8), 3 * speed), np.full((3, 4), at.altitude_ft)))


MODELS = {at: model(at) for at in IDENTIFIED}


@pytest.mark.parametrize("at", LEFT_OUT)
def test_a_straight_line_is_met_between_the_points(at):
    found, truth = between(MODELS, at), model(at)
    for mine, true in (
        (found.state.A, truth.state.A),
        (found.state.B, truth.state.B),
        (found.output.C, truth.output.C),
    ):
        assert mine == pytest.approx(true, rel=1e-14)
    assert found.output.D[0, 0] == at.altitude_ft


def test_a_point_itself_is_its_model_and_the_nearest_is_near():
    assert between(MODELS, IDENTIFIED[2]) is MODELS[IDENTIFIED[2]]
    assert nearest(MODELS, Condition("HA", 6000, 57)).state.A[0, 0] == 50.0


def test_no_model_is_stretched_beyond_its_ends():
    for wanted in (Condition("HA", 6000, 29), Condition("HA", 6000, 116), Condition("HA", 4000, 50)):
        with pytest.raises(BadInput, match="speed"):
            between(MODELS, wanted)


def test_the_envelope_is_the_thesis_one():
    assert len(set(IDENTIFIED)) == 22
    assert {at.loading for at in IDENTIFIED} == {"HA", "HF"}
    assert (min(at.speed_kts for at in IDENTIFIED), max(at.speed_kts for at in IDENTIFIED)) == (30, 115)
    assert condition_of("HA6000ft-50kts") in IDENTIFIED
    assert not set(IDENTIFIED) & set(LEFT_OUT)


def test_names_read_back_and_wrong_ones_are_refused():
    assert all(condition_of(at.name) == at for at in IDENTIFIED)
    with pytest.raises(BadInput, match="flight condition"):
        condition_of("HA6000m-50kts")
