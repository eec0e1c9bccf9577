"""What the data tell of a parameter, apart from what it was given as its size."""

from pathlib import Path

import numpy as np

from identification.results.result import Identification, identification, signs_of
from identification.stages.logs import identify_logs
from records.log import RunLog
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.simulate import simulate
from tests.own_plants import PLAIN


def _found(tmp_path: Path, K_stated: float, names: tuple[str, ...]) -> Identification:
    """The plain arm, K = 0.05 N m/V, from a log of it and a plant file that states another K."""
    path = PLAIN.write(tmp_path, "plain")
    arm, t_s = bind(load_plant(path)), 0.01 * np.arange(1500)
    u = np.repeat(np.random.default_rng(1).uniform(-3.0, 3.0, 30), 50)[:, None]
    log = RunLog(log_columns(arm.model), 0.01, "open", t_s, u, simulate(arm, t_s, [0.0, 0.0], u).y)
    path.write_text(path.read_text().replace("value = 0.05", f"value = {K_stated}"))
    stated = bind(load_plant(path))
    fit = identify_logs(stated, {"log": log}, names)
    return identification(stated.plant, [("log", fit)], fit.belief, signs=signs_of(stated.model))


def test_what_only_a_common_factor_holds_is_not_told(tmp_path: Path) -> None:
    """Truth: every torque and the inertia are known to a common factor alone, at any size that the file gives them.

    By the share that each has in that factor they looked told, to 29 %.
    """
    assert [entry.name for entry in _found(tmp_path, 0.01, ("J", "K", "b", "G")).estimates if entry.identified] == []


def test_with_one_of_them_held_the_others_are(tmp_path: Path) -> None:
    """Truth: the plant that made the log, to 3 sd."""
    for entry in _found(tmp_path, 0.05, ("J", "b", "G")).estimates:
        assert entry.identified
        assert abs(entry.value - {"J": 0.01, "b": 0.02, "G": 0.2}[entry.name]) < 3.0 * entry.sd
