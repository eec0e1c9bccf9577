"""A law: a plant that takes thirty-two times as long for all that it does is diagnosed alike, its times thirty-two times as long."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.diagnose import Material, diagnose
from records.diagnosis import Diagnosis
from records.log import RunLog
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from tests.own_plants import HEATER

SLOWER = 32.0
ROW, LATE, C, G = 0.01, 6, 0.64, 0.8  # seconds, rows, J/K, W/K: T' = (heat(t - 0.06 s) - G T) / C, of 0.8 s


def heated(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Powers (n,) that change every second or two and come six rows late, and readings (n,) of 0.01 K with noise of as much; exact, as
    nothing changes within a row."""
    rng = np.random.default_rng(seed)
    heat = np.repeat(rng.uniform(5.0, 55.0, 20), rng.integers(100, 200, 20))[:1500]
    arrives = np.concatenate([np.full(LATE, heat[0]), heat[:-LATE]])
    keep = np.exp(-G * ROW / C)
    T = np.empty(len(heat))
    T[0] = heat[0] / G
    for row in range(1, len(heat)):
        T[row] = keep * T[row - 1] + (1.0 - keep) * arrives[row - 1] / G
    return heat, np.round((T + rng.normal(0.0, 0.01, len(T))) / 0.01) * 0.01


def diagnosed(folder: Path, slower: float) -> Diagnosis:
    numbers = {**HEATER.parameters, "C": (1.05 * slower * C, 0.1 * slower * C, "J K^-1")}
    bound = bind(load_plant(replace(HEATER, parameters=numbers).write(folder, "body")))
    assert bound.model.second_s == slower

    def log(seed: int) -> RunLog:
        heat, read = heated(seed)
        t_s = slower * ROW * np.arange(len(heat))
        return RunLog(log_columns(bound.model), slower * ROW, "open", t_s, heat[:, None], read[:, None])

    return diagnose(bound, Material([log(1), log(2)], [log(3)], ["later"], [None, None])).diagnosis


def test_a_slower_plant_has_the_same_answer_in_its_own_time(tmp_path: Path) -> None:
    quick, slow = diagnosed(tmp_path / "quick", 1.0), diagnosed(tmp_path / "slow", SLOWER)
    for found, slower in ((quick, 1.0), (slow, SLOWER)):
        assert found.verdict == "gap"
        assert {"heater.delay", "probe.delay"} >= set(found.found) > set()
        assert found.effects[0].parameters["tau"].value == pytest.approx(slower * LATE * ROW, rel=0.02)
        assert found.shrinkage is not None
        assert found.shrinkage.window_s == slower
    assert slow.effects[0].probability == pytest.approx(quick.effects[0].probability, abs=0.02)
