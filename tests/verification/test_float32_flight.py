"""A whole flight in float32 against the double-precision law on the same inputs: what differs is the reference filter."""

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from codegen.twin import FULL_SCALE_V, PWM_TICKS
from design.law import law_reset, law_step
from design.settings import read_settings
from design.table import design
from records.log import RunLog
from records.plant import load_plant
from records.table import ControllerTable
from sim.bind import bind
from sim.loop import Controller, fly_law
from sim.manoeuvres import flight
from tests.law_tables import changed_axis
from verification.host_law import host_law

PLANT = Path(__file__).resolve().parents[2] / "plants" / "ce150.toml"
HALF_TICK_V = FULL_SCALE_V / PWM_TICKS / 2.0
Array = NDArray[np.float64]


@cache
def flown() -> tuple[ControllerTable, RunLog]:
    """104 s of the nonlinear plant under the double-precision law of the table that is designed for it."""
    bound = bind(load_plant(PLANT))
    table = design(bound, read_settings(bound))[0]
    return table, fly_law(bound, table, flight(bound, table.sample_period_s))


def _answers(law: Controller, references_rad: Array, y: Array) -> Array:
    law.reset(*y[0].tolist())
    return np.array([law.step(*row) for row in np.hstack([references_rad, y]).tolist()])


def _double(table: ControllerTable, references_rad: Array, y: Array) -> tuple[Array, Array]:
    """Voltages of the double-precision law, and its filtered references."""
    state, answers, filtered = law_reset(table, *y[0].tolist()), [], []
    for row in np.hstack([references_rad, y]).tolist():
        state, *voltages = law_step(table, state, *row)
        answers.append(voltages)
        filtered.append((state.elevation.x2_rad, state.azimuth.x2_rad))
    return np.array(answers), np.array(filtered)


def test_in_float32_the_reference_filter_is_what_differs_and_all_else_agrees_within_a_fifth_of_half_a_tick() -> None:
    """Truth: a filter that stops short by half an ulp over its gain; fed with references that are filtered already, little is left."""
    table, log = flown()
    references_rad = np.column_stack([log.extra["psi_ref_rad"], log.extra["phi_ref_rad"]])
    exact, filtered_rad = _double(table, references_rad, log.y)
    with_filter = np.abs(_answers(host_law(table), references_rad, log.y) - exact) / HALF_TICK_V
    unfiltered = table
    for axis in ("elevation", "azimuth"):
        unfiltered = changed_axis(unfiltered, axis, prefilter_time_constant_s=0.0)
    without = np.abs(_answers(host_law(unfiltered), filtered_rad, log.y) - _double(unfiltered, filtered_rad, log.y)[0])
    assert 0.5 < with_filter.max() < 2.0
    assert without.max() / HALF_TICK_V < 0.2
