"""A sensor whose range ends within its axis' way is told with level and times; a stop, a turn and a rest at an extreme are not."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.integrity import as_read, examine
from logcheck.stands.clipped import clipped_findings
from records.log import RunLog
from sim.columns import log_columns
from sim.simulate import simulate
from tests.logcheck.test_parts import PLANT, STEP_RAD, STEPS, log_of, rounded

POSITIONS = ("psi_rad", "phi_rad")
NONE = np.zeros(2000, bool)
LEVEL_RAD = 137 * STEP_RAD  # 0.21 rad, of a swing of 0.3 rad


def clipped(low_rad: float, high_rad: float) -> RunLog:
    log = log_of()
    return replace(log, y=np.column_stack([np.clip(log.y[:, 0], low_rad, high_rad), log.y[:, 1]]))


@pytest.mark.parametrize(
    ("low_rad", "high_rad", "told"),
    [
        (-9.0, LEVEL_RAD, ("psi_rad never exceeds 0.21016 rad",)),
        (-LEVEL_RAD, 9.0, ("psi_rad never falls below -0.21016 rad",)),
        (-LEVEL_RAD, LEVEL_RAD, ("never exceeds 0.21016 rad", "never falls below -0.21016 rad")),
    ],
)
def test_a_sensor_that_ends_within_the_way_is_told_and_left_out(
    low_rad: float, high_rad: float, told: tuple[str, ...]
) -> None:
    """Truth: psi swings by 0.3 rad and its sensor ends at 0.21 rad, above, below or on both sides."""
    log = clipped(low_rad, high_rad)
    found = examine([log], PLANT, names=["log"])
    (finding,) = [entry for entry in found.findings if entry.kind == "clipped_sensor"]
    assert all(part in finding.sentence for part in told)
    beyond = log.y[:, 0] != log_of().y[:, 0]
    unread = np.isnan(as_read(log, found.logs[0]).y)
    assert unread[beyond, 0].all()
    assert not unread[~beyond & (np.abs(log.y[:, 0]) != LEVEL_RAD), 0].any()
    assert not unread[:, 1].any()


def test_a_noisy_sensor_at_its_end_is_told_and_one_that_rests_at_zero_is_not() -> None:
    """Truth: noise of 1 mrad on a slow swing; the sensor reads up to 0.25 rad alone, or nothing below zero."""
    log = log_of()
    true_rad = 0.3 * np.sin(0.4 * log.t_s) + np.random.default_rng(1).normal(0.0, 1e-3, 2000)
    for psi_rad, count in ((np.minimum(true_rad, 0.25), 1), (np.maximum(true_rad, 0.0), 0)):
        noisy = replace(log, y=np.column_stack([psi_rad, log.y[:, 1]]))
        assert len(list(clipped_findings(noisy, "log", {}, NONE))) == count


@pytest.mark.parametrize("stops", [{}, {"psi_rad": (-0.25, 0.25)}])
def test_a_turn_at_the_extreme_is_no_end_and_the_end_at_a_stop_is_the_stop_s(
    stops: dict[str, tuple[float, float]],
) -> None:
    log = clipped(-LEVEL_RAD, LEVEL_RAD) if stops else log_of()
    assert list(clipped_findings(log, "log", STEPS, NONE, POSITIONS, stops)) == []


@pytest.mark.parametrize("seed", range(6))
def test_an_axis_that_is_thrown_against_its_stops_is_not_clipped(seed: int) -> None:
    """Truth: the plant with its stops, under inputs that leap within all of their range every 0.2 s to 3 s."""
    rng, t_s = np.random.default_rng(seed), 0.01 * np.arange(2000)
    hold = int(rng.integers(20, 300))
    u = np.column_stack([np.repeat(rng.uniform(*ends, 2000 // hold + 1), hold)[:2000] for ends in ((0, 10), (-6, 6))])
    run = simulate(PLANT, t_s, np.zeros(len(PLANT.model.states)), u)
    assert run.y is not None
    log = RunLog(log_columns(PLANT.model), 0.01, "open", t_s, u, rounded(run.y))
    assert "clipped_sensor" not in {entry.kind for entry in examine([log], PLANT, names=["log"]).findings}


def test_a_rate_that_an_input_sets_going_from_its_extreme_is_not_clipped() -> None:
    """Truth: a first-order rate in steps of its sensor, which rests at its extreme and leaves it at full speed."""
    log = log_of()
    target = np.where((log.t_s // 2.0) % 2.0 == 0.0, 0.3, 0.0)
    rate = np.zeros(2000)
    for row in range(1, 2000):
        rate[row] = rate[row - 1] + 0.1 * (target[row] - rate[row - 1])
    log = replace(log, y=np.column_stack([rounded(rate), log.y[:, 1]]))
    assert list(clipped_findings(log, "log", STEPS, NONE)) == []
