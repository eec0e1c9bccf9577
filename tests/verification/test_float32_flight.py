"""A whole flight in float32 against the double-precision law on the same inputs, and the reference filter that must arrive for it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from codegen import law_frame
from codegen.law_equations import scheduled_law
from codegen.law_frame import prefilter
from codegen.twin import PWM_TICKS, Float32Twin
from design.law import law_reset, law_step
from design.settings import read_settings
from design.table import design
from records.log import RunLog
from records.loops import FULL_SCALE_V
from records.plant import load_plant
from records.table import ControllerTable
from sim.bind import bind
from sim.loop import Controller, fly_law
from sim.manoeuvres import flight
from tests.law_tables import ce150_table
from tests.soak import sampled
from verification.host_law import host_law

PLANT = Path(__file__).resolve().parents[2] / "plants" / "ce150.toml"
HALF_TICK_V = FULL_SCALE_V / PWM_TICKS / 2.0
Array = NDArray[np.float64]


def designed() -> ControllerTable:
    """The table that is designed for the plant; three seconds."""
    bound = bind(load_plant(PLANT))
    return design(bound, read_settings(bound))[0]


def flown(table: ControllerTable) -> RunLog:
    """104 s of the nonlinear plant under the double-precision law."""
    bound = bind(load_plant(PLANT))
    return fly_law(bound, table, flight(bound, table.sample_period_s))


def _answers(law: Controller, references_rad: Array, y: Array) -> Array:
    law.reset(*y[0].tolist())
    return np.array([law.step(*row) for row in np.hstack([references_rad, y]).tolist()])


def _double(table: ControllerTable, references_rad: Array, y: Array) -> Array:
    state, answers = law_reset(table, *y[0].tolist()), []
    for row in np.hstack([references_rad, y]).tolist():
        state, voltages = law_step(table, state, *row)
        answers.append(voltages)
    return np.array(answers)


@pytest.mark.parametrize("table_of", sampled([ce150_table, designed], keep=[ce150_table]))
def test_on_the_inputs_of_a_whole_flight_float32_is_within_a_quarter_of_half_a_pwm_tick_of_double_precision(
    table_of: Callable[[], ControllerTable],
) -> None:
    """Truth: 0.06 (u_M) and 0.18 (u_T) of half a tick; with filters that stop short of their targets it was 1.7."""
    table = table_of()
    log = flown(table)
    assert log.t_s[-1] >= 95.0
    references_rad = np.column_stack([log.extra["psi_ref_rad"], log.extra["phi_ref_rad"]])
    difference_V = np.abs(_answers(host_law(table), references_rad, log.y) - _double(table, references_rad, log.y))
    assert difference_V.max() < 0.25 * HALF_TICK_V
    assert difference_V[-1000:].max() < 0.2 * HALF_TICK_V


def test_the_reference_filter_arrives_at_its_target_and_stays() -> None:
    """Truth: both poles equal the target bit for bit; a pole of 1 % a sample rounds its step away some 50 places before."""
    targets, starts = np.meshgrid([0.3, -0.31, 0.0, 1e-44, -1e-44, 0.5], [0.5, -0.5, 0.3])
    targets_rad, starts_rad = (values.ravel().astype(np.float32) for values in (targets, starts))
    twin = Float32Twin(ce150_table())
    state = law_frame.law_reset(scheduled_law(3), twin.law, twin.lanes, (starts_rad, starts_rad))
    for axis, numbers in ((state.axes[0], twin.law.axes[0]), (state.axes[1], twin.law.axes[1])):
        for _ in range(4500):
            axis = prefilter(numbers, twin.lanes, axis, targets_rad)
        assert np.array_equal(axis.reference_1_rad, targets_rad)
        assert np.array_equal(axis.reference_2_rad, targets_rad)
