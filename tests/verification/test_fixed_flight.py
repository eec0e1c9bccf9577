"""A whole flight in fixed point against the double-precision law: the same inputs give the same voltages, and so does the loop."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from codegen.twin import PWM_TICKS
from design.law import law_reset, law_step
from records.log import RunLog
from records.loops import FULL_SCALE_V
from records.plant import load_plant
from records.table import ControllerTable
from sim.bind import BoundPlant, bind
from sim.loop import fly, fly_law
from sim.manoeuvres import flight
from tests.law_tables import ce150_table
from verification.host_law import host_law

PLANT = Path(__file__).resolve().parents[2] / "plants" / "ce150.toml"
HALF_TICK_V = FULL_SCALE_V / PWM_TICKS / 2.0


@cache
def flown() -> tuple[BoundPlant, ControllerTable, RunLog]:
    """The nonlinear plant flown by the compiled fixed-point law for 104 s."""
    bound, table = bind(load_plant(PLANT)), ce150_table()
    law = host_law(table, "fixed")
    return bound, table, fly(bound, law, flight(bound, table.sample_period_s), table_digest=table.digest)


def test_on_the_inputs_of_a_whole_flight_both_laws_agree_within_half_a_pwm_tick_without_drift() -> None:
    _, table, log = flown()
    assert log.t_s[-1] >= 95.0
    difference_V = np.abs(_double(table, log) - log.u)
    assert difference_V.max() < HALF_TICK_V
    assert difference_V[-1000:].max() < 0.2 * HALF_TICK_V


def test_the_closed_loops_stay_within_an_encoder_step_of_each_other() -> None:
    """Encoder steps make a pair of loops part and meet again by one step: no more than that, at any time."""
    bound, table, log = flown()
    double = fly_law(bound, table, flight(bound, table.sample_period_s))
    assert np.abs(log.y - double.y).max() < 1.5 * table.axes[0].resolution_rad


def test_without_encoder_steps_both_closed_loops_command_the_same_within_half_a_pwm_tick() -> None:
    """A step of an encoder is worth volts to the law's highest difference; all else that the two loops differ by is rounding."""
    bound, table, _ = flown()
    smooth = replace(bound, plant=replace(bound.plant, sensors=dict.fromkeys(bound.plant.sensors, 0.0)))
    manoeuvre = flight(bound, table.sample_period_s)
    fixed = fly(smooth, host_law(table, "fixed"), manoeuvre, table_digest=table.digest)
    double = fly_law(smooth, table, manoeuvre)
    assert np.abs(fixed.u - double.u).max() < HALF_TICK_V
    assert np.abs(fixed.y - double.y).max() < 1e-4


def _double(table: ControllerTable, log: RunLog) -> NDArray[np.float64]:
    state, outputs = law_reset(table, *log.y[0].tolist()), []
    for psi_ref_rad, phi_ref_rad, y in zip(log.extra["psi_ref_rad"], log.extra["phi_ref_rad"], log.y, strict=True):
        state, voltages_V = law_step(table, state, float(psi_ref_rad), float(phi_ref_rad), *y.tolist())
        outputs.append(voltages_V)
    return np.array(outputs)
