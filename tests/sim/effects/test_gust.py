"""One draw of a gust has the size and the memory that its numbers state."""

from pathlib import Path

import numpy as np
import pytest
import sympy

from records.plant import load_plant
from sim.added_effects import library
from sim.bind import BoundPlant, bind
from sim.model import TIME


@pytest.fixture(scope="module")
def plant() -> BoundPlant:
    return bind(load_plant(Path("plants/ce150.toml")))


@pytest.mark.parametrize("T", [0.3, 2.0])
def test_a_gust_has_its_standard_deviation_and_forgets_in_its_time(plant: BoundPlant, T: float) -> None:
    # Truth: an Ornstein-Uhlenbeck process of 1 mN m, whose autocorrelation is exp(-lag / T). Sixteen sines of it: 5 % of the size over
    # 2000 T, and 0.1 of the correlation up to 2 T, where sines at fixed frequencies still keep step.
    sigma = 1e-3
    model = plant.model
    effect = library(plant)["elevation.gust"]
    assert effect.edit is not None
    torque = effect.edit(model, sigma, T).axes[0].torque - model.axes[0].torque
    t_s = np.arange(0.0, 2000.0 * T, T / 50.0)
    g = sympy.lambdify(TIME, torque, "numpy")(t_s)
    assert np.std(g) == pytest.approx(sigma, rel=0.05)
    assert abs(np.mean(g)) < 0.02 * sigma
    for lag in (0.5, 1.0, 2.0):
        rows = round(50 * lag)
        assert np.mean(g[rows:] * g[:-rows]) / np.var(g) == pytest.approx(np.exp(-lag), abs=0.1)
