"""Where a flight starts: rotors that nobody reads may have run up before the log begins, or not."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.filter.filter_input import filter_input_of
from diagnosis.hypothesis.initial_state import start_of
from diagnosis.library.effect_library import EffectLibrary, effect_library
from records.log import RunLog
from sim.bind import BoundPlant
from sim.loop import fly_law
from sim.manoeuvres import flight
from tests.plants import stated_table

AT_REST_RAD_S, LEVEL_RAD_S = 0.0, 415.0  # of the main rotor, switched off and in level flight


@pytest.fixture(scope="module")
def library(plant: BoundPlant) -> EffectLibrary:
    return effect_library(plant)


@pytest.fixture(scope="module")
def flown(plant: BoundPlant) -> RunLog:
    """The default flight, which starts at the stop with both rotors at rest."""
    table = stated_table("ce150")
    return fly_law(plant, table, flight(plant))


def begun(library: EffectLibrary, log: RunLog, first: int) -> float:
    """The main rotor's speed from which the filter begins the log's rows from `first` on."""
    part = replace(log, t_s=log.t_s[first:], u=log.u[first:], y=log.y[first:], extra={})
    x0, _ = start_of(library, filter_input_of(part, library.bound.plant, library.outputs), ())
    return float(x0[library.states.index("omega_M_rad_s")])


def test_rotors_at_rest_begin_there(library: EffectLibrary, flown: RunLog) -> None:
    # The flight's own inputs would hold 413 rad/s from its first row on.
    assert begun(library, flown, 0) == pytest.approx(AT_REST_RAD_S, abs=1.0)


@pytest.mark.parametrize("first", [2000, 3500, 5000, 8000])
def test_rotors_that_run_begin_near_their_speed(library: EffectLibrary, flown: RunLog, first: int) -> None:
    # Flight needs 396 rad/s at the stop and 415 rad/s level: within 20 % of that, as half of it would let the helicopter fall.
    assert begun(library, flown, first) == pytest.approx(LEVEL_RAD_S, rel=0.2)


def test_readings_that_are_no_numbers_leave_a_start(library: EffectLibrary, flown: RunLog) -> None:
    blind = replace(flown, y=np.full_like(flown.y, np.nan), extra={})
    x0, p0 = start_of(library, filter_input_of(blind, library.bound.plant, library.outputs), ())
    assert np.isfinite(x0).all()
    assert (p0 > 0.0).all()


@pytest.mark.parametrize("size", [0.01, 0.3])
def test_a_start_is_as_unsure_as_its_readings_move(library: EffectLibrary, flown: RunLog, size: float) -> None:
    # Truth: both angles swing by +-size at 2 rad/s: a range of 2 size, speeds of 2 size a second, over 0.1 s 0.2 % less.
    way = size * np.sin(2.0 * flown.t_s)
    log = replace(flown, y=np.column_stack((way, way)), extra={})
    _, p0 = start_of(library, filter_input_of(log, library.bound.plant, library.outputs), ())
    sd = dict(zip(library.states, np.sqrt(p0), strict=True))
    assert sd["psi_rad"] == pytest.approx(decisions.START_SHARE * 2.0 * size, rel=0.01)
    assert sd["psi_dot_rad_s"] == pytest.approx(decisions.START_SHARE * 2.0 * size, rel=0.01)
