"""An axis that is held: its readings, which noise tips to and fro between two counts, are of one angle and prove nothing."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.detect.form_scores import form_scores, gains
from diagnosis.detect.linearisation import linearised
from diagnosis.diagnose import Material, diagnose
from diagnosis.hypothesis.case import make_case
from diagnosis.hypothesis.held_axes import with_held
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from sim.bind import BoundPlant
from tests.diagnosis.conftest import SPRING, Fly
from tests.diagnosis.nominal import nominal_fit

STEP_RAD = 1.534e-3


def held(fly: Fly, seed: int, seconds: float) -> RunLog:
    """A run with the azimuth held between two counts, of which the reading's noise chooses one or the other."""
    log = fly(seed, seconds=seconds, rig_seed=62, locked=("azimuth",))
    y = log.y.copy()
    y[:, 1] += STEP_RAD * (np.random.default_rng(seed).random(len(y)) < 0.4)
    return replace(log, y=y)


def test_it_stands_where_its_readings_are_in_the_mean_and_they_count_no_more(plant: BoundPlant, fly: Fly) -> None:
    log = held(fly, 61, 6.0)
    case = make_case(effect_library(plant), [log])
    (azimuth,) = [axis for axis in plant.model.axes if axis.name == "azimuth"]
    flight, states = case.flights[0], case.library.states
    angle, speed = states.index(str(azimuth.position)), states.index(str(azimuth.velocity))
    assert flight.x0[angle] == pytest.approx(float(np.mean(log.y[:, 1])))
    assert (flight.p0[angle], flight.x0[speed], flight.p0[speed]) == (0.0, 0.0, 0.0)
    assert not np.isfinite(flight.filter_input.y[:, 1]).any()
    assert np.isfinite(flight.filter_input.y[:, 0]).all()


@pytest.mark.soak  # a whole diagnosis; what it guards of the forms the last test does
def test_what_a_free_log_shows_is_named_beside_a_log_with_that_axis_held(plant: BoundPlant, fly: Fly) -> None:
    logs = [fly(62, SPRING, rig_seed=62), held(fly, 63, 10.0)]
    found = diagnose(plant, Material(logs, [], [], [None, None], names=["free", "held"])).diagnosis
    assert found.effects[0].effect == "azimuth.cable_spring"
    # Truth: beside the spring no form has anything to explain, so an unknown effect is as unlikely as without a hold-out it can be.
    assert found.comparison is not None
    assert found.comparison.left_nats < decisions.TAKEN_IN
    assert found.unknown.probability < 0.5 * found.effects[0].probability
    assert not any("contradict" in note for note in found.notes)


def test_an_axis_that_is_free_is_left_as_it_is(plant: BoundPlant, fly: Fly) -> None:
    library = effect_library(plant)
    (flight,) = make_case(library, [fly(65, seconds=6.0)]).flights
    found, x0, p0 = with_held(library, flight.filter_input, flight.x0, flight.p0, ())
    assert np.array_equal(found.y, flight.filter_input.y, equal_nan=True)
    assert (x0.tolist(), p0.tolist()) == (flight.x0.tolist(), flight.p0.tolist())


def test_nothing_is_seen_in_a_held_axis(plant: BoundPlant, fly: Fly) -> None:
    case = make_case(effect_library(plant), [held(fly, 64, 6.0)])
    by_form = form_scores(linearised(case, nominal_fit(case)))
    of_azimuth = [gain for form, gain in zip(by_form.forms, gains(by_form.scores), strict=True) if "phi" in form.place]
    assert max(of_azimuth, default=0.0) == 0.0
