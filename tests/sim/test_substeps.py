"""How many steps a sample of a flight takes: a motion is followed to its rate, and what settles within a sample stays finite."""

import math
from pathlib import Path

import numpy as np
import pytest

from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.simulate import Conditions, simulate
from sim.substeps import MOST_SUBSTEPS, fastest_rad_s, steps_a_stretch
from tests.own_plants import OwnPlant
from tests.plants import bound

STAGE = """
i, u = symbol("i_A"), symbol("u_V")
return Model(
    name="NAME", states=(i,), inputs=(u,), outputs={"i_A": i}, parameters=PARAMETERS,
    rates={i: p["w"] * (u - i)}, axes=(), input_limits={u: (-12, 12)},
    places=Places(inputs={"input": InputPlace(u, "V", 12.0)}, sensors={"i_sensor": SensorPlace("i_A", "A", 6.0)}),
)
"""
PERIOD_S = 5e-4


def stage(folder: Path, rate_rad_s: float) -> BoundPlant:
    """An amplifier's current, w (u - i)."""
    plant = OwnPlant({"w": (rate_rad_s, 0.01 * rate_rad_s, "s^-1")}, {"i_A": 1e-3}, STAGE)
    return bind(load_plant(plant.write(folder, "stage")))


@pytest.mark.parametrize("rate_rad_s", [200.0, 2000.0, 4000.0, 10_000.0])
def test_a_stage_decays_at_its_own_rate(rate_rad_s: float, tmp_path: Path) -> None:
    # Truth: exp(-w t), its rate to 1e-4.
    plant = stage(tmp_path, rate_rad_s)
    steps = steps_a_stretch(plant, fastest_rad_s(plant, [1.0]), PERIOD_S)
    run = simulate(plant, np.arange(2) * PERIOD_S, np.ones(1), np.zeros((2, 1)), Conditions(substeps=steps, keep="x"))
    assert run.x is not None
    assert -math.log(run.x.ravel()[1]) / PERIOD_S == pytest.approx(rate_rad_s, rel=1e-4)


def test_what_settles_within_a_sample_takes_no_more_steps_than_keep_it_finite(tmp_path: Path) -> None:
    # Truth: of 100 time constants nothing is left, exp(-100), in a tenth of the steps that would follow it; of 2500 so many are enough.
    plant = stage(tmp_path, 100.0 / PERIOD_S)
    steps = steps_a_stretch(plant, fastest_rad_s(plant, [1.0]), PERIOD_S)
    run = simulate(plant, np.arange(2) * PERIOD_S, np.ones(1), np.zeros((2, 1)), Conditions(substeps=steps, keep="x"))
    assert run.x is not None
    assert abs(run.x.ravel()[1]) < 1e-6
    assert steps <= 40
    assert steps_a_stretch(plant, 2500.0 / PERIOD_S, PERIOD_S) <= MOST_SUBSTEPS


@pytest.mark.parametrize("name", ["ce150", "ce150_velagic", "aeroshield", "quanser_aero"])
def test_a_slow_rig_takes_one_step_a_sample(name: str) -> None:
    rig = bound(name)
    assert steps_a_stretch(rig, fastest_rad_s(rig, np.zeros(len(rig.model.states))), 0.01) == 1
