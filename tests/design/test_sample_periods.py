"""From 0.5 to 50 ms a design places the same poles, at 1 kHz as at 20 Hz, and python-control's conversion agrees as far as z lets it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from design.schedule import CONSTANT_Q3_BELOW_S
from design.settings import SAMPLE_PERIODS_S, read_settings
from design.table import design
from records.loops import LOOPS
from records.plant import load_plant
from sim.bind import bind
from sim.equilibrium import equilibrium
from sim.loop import fly, fly_law
from sim.manoeuvres import Leg, flight, manoeuvre
from sim.tracking import tracking
from tests.angles import few_angles
from tests.soak import SOAK, sampled
from verification.host_law import host_law

BOUND = bind(load_plant(Path(__file__).parents[2] / "plants" / "ce150.toml"))
PERIODS_S = (0.0005, 0.0007, 0.001, 0.0012, 0.002, 0.005, 0.007, 0.02, 0.05)


@pytest.fixture(autouse=True)
def angles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reports at few angles, in a soak at all."""
    if not SOAK:
        few_angles(monkeypatch)


@pytest.mark.parametrize("period_s", sampled(PERIODS_S, keep=[0.0005, 0.05]))
def test_the_slowest_poles_stay_near_where_they_were_placed(period_s: float) -> None:
    """Within 6 %, and within a fifth where q_3 is the same at all elevations."""
    settings = replace(read_settings(BOUND), sample_period_s=period_s)
    table, report = design(BOUND, settings)
    assert SAMPLE_PERIODS_S[0] <= table.sample_period_s == period_s <= SAMPLE_PERIODS_S[1]
    constant = period_s < CONSTANT_Q3_BELOW_S
    for entry in report.pole_entries():
        assert entry["stable"]
        assert entry["worst_slowest_rad_s"] < (0.8 if constant else 0.94) * entry["designed_slowest_rad_s"]


@pytest.mark.parametrize("period_s", sampled(PERIODS_S, keep=[0.001]))
def test_encoder_steps_are_not_rectified_at_any_period(period_s: float) -> None:
    """A step of 30 deg upwards in double precision: it arrives, and overshoots by an encoder step at most."""
    table = design(BOUND, replace(read_settings(BOUND), sample_period_s=period_s))[0]
    begin, end = np.radians(-30.0), 0.0
    legs = [(Leg(0.0, -30.0), Leg(0.5, 0.0)), (Leg(0.0, 0.0),)]
    whole = manoeuvre("up", equilibrium(BOUND, begin).x0, 6.0, period_s, legs)
    psi_rad = fly_law(BOUND, table, whole).y[:, 0]
    assert abs(psi_rad[-1] - end) < 1.5 * table.axes[0].resolution_rad
    assert psi_rad.max() < end + 2.5 * table.axes[0].resolution_rad


@pytest.mark.soak
@pytest.mark.parametrize("arithmetic", sampled(("float32", "fixed"), keep=["float32"]))
def test_at_the_shortest_period_the_generated_law_flies_as_double_precision_does(arithmetic: str) -> None:
    """No axis overshoots by more than a hundredth; with a roll-off the azimuth is lost there."""
    period_s = SAMPLE_PERIODS_S[0]
    table = design(BOUND, replace(read_settings(BOUND), sample_period_s=period_s))[0]
    log = fly(BOUND, host_law(table, arithmetic), flight(BOUND, period_s), table_digest=table.digest)
    for loop in LOOPS:
        assert tracking(log, loop).overshoot < 0.01
        assert tracking(log, loop).mean_error_rad < np.radians(3.0)
