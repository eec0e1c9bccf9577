"""A plant that takes minutes for what a rig does in a second."""

from pathlib import Path

import numpy as np

from identification.stages.logs import identify_logs
from records.log import RunLog
from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from tests.own_plants import HEATER, OwnPlant

TRUE = {"C": 900.0, "G": 0.7, "S": 293.0}
STATED = {"C": 700.0, "G": 1.0, "S": 296.0}
SD = {"C": 200.0, "G": 0.5, "S": 5.0}
UNIT = {"C": "J K^-1", "G": "W K^-1", "S": "K"}
PERIOD_s, ROWS, STEP_K, FIRST_K, HOTTER_K = 0.05, 1601, 0.01, 364.0, 364.9


def _oven(folder: Path, values: dict[str, float]) -> BoundPlant:
    """The heater in surroundings of S, its time constant C / G some twenty minutes."""
    parameters = {name: (value, SD[name], UNIT[name]) for name, value in values.items()}
    body = HEATER.body.replace('p["G"] * T', 'p["G"] * (T - p["S"])')
    return bind(load_plant(OwnPlant(parameters, {"T_K": STEP_K}, body).write(folder, "oven")))


def _by_thermostat(oven: BoundPlant) -> RunLog:
    """80 s of full heat or none, by which side of a level the probe is; the level changes every 20 s, and the oven moves by 0.2 K."""
    C, G, S = TRUE.values()
    t_s, T = PERIOD_s * np.arange(ROWS), FIRST_K
    u, y = np.zeros((ROWS, 1)), np.zeros((ROWS, 1))
    for k in range(ROWS):
        y[k] = STEP_K * np.round(T / STEP_K)
        u[k] = 60.0 if y[k, 0] < (HOTTER_K if int(t_s[k] / 20.0) % 2 else FIRST_K) else 0.0
        rest = S + u[k, 0] / G
        T = rest + (T - rest) * np.exp(-G / C * PERIOD_s)
    return RunLog(log_columns(oven.model), PERIOD_s, "closed", t_s, u, y)


def test_a_slow_plant_is_sought_from_windows_of_its_own_pace(tmp_path: Path) -> None:
    """Truth: the oven that made the log, to 3 sd. From windows of half a second the loss came out five sd off, the surroundings 22."""
    log = _by_thermostat(_oven(tmp_path / "true", TRUE))
    belief = identify_logs(_oven(tmp_path, STATED), {"log": log}, tuple(TRUE)).belief
    off = (belief.mean - np.array([TRUE[name] for name in belief.names])) / belief.sd
    assert np.max(np.abs(off)) < 3.0, dict(zip(belief.names, off.tolist(), strict=True))
