"""How far ahead an unstable plant is asked for its readings."""

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from diagnosis.hypothesis.case import FilteredLog
from diagnosis.validate.misfit import LEAST_WINDOW_ROWS, foreseen_s
from records.plant import load_plant
from sim.bind import bind
from tests.own_plants import MAGNET


def log(x0: list[float], u_V: float, step_s: float) -> FilteredLog:
    """What is asked of one: its start, its inputs and its rows' distance."""
    found: Any = SimpleNamespace(x0=np.array(x0), log=SimpleNamespace(u=np.full((10, 1), u_V)), step_s=step_s)
    return cast(FilteredLog, found)


def test_a_ball_below_its_magnet_is_asked_for_the_time_constant_of_an_error(tmp_path: Path) -> None:
    """Truth: at rest 10 mm below, an error grows by exp(sqrt(2 g / z) t), 44.3 rad/s: a time constant of 23 ms."""
    bound = bind(load_plant(MAGNET.write(tmp_path, "magnet")))
    current_A = 0.01 * math.sqrt(0.068 * 9.81 / 6.5e-5)
    held = log([0.0, 0.0, current_A], 10.0 * current_A, 1e-3)
    assert foreseen_s(bound, held) == pytest.approx(1.0 / math.sqrt(2 * 9.81 / 0.01), rel=1e-6)


def test_rows_that_are_far_apart_are_a_few_at_least_and_a_stable_plant_is_asked_for_a_second(tmp_path: Path) -> None:
    bound = bind(load_plant(MAGNET.write(tmp_path, "magnet")))
    current_A = 0.01 * math.sqrt(0.068 * 9.81 / 6.5e-5)
    assert foreseen_s(bound, log([0.0, 0.0, current_A], 10.0 * current_A, 0.05)) == LEAST_WINDOW_ROWS * 0.05
    assert foreseen_s(bound, log([0.0, 0.0, 0.0], 0.0, 1e-3)) == 1.0
