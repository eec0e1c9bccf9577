"""A command and an axis in each other's place are told before anything is concluded; a column that a hand switches is none."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.between import duplicate_findings
from logcheck.integrity import OTHER_NUMBERS, demand, examine
from logcheck.leaps.motion import wrap_findings
from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant, bind
from tests.logcheck.test_parts import STEPS, log_of
from twinlaw import fly


@pytest.fixture(scope="module")
def log(arm: BoundPlant) -> RunLog:
    return fly(arm)


def test_an_input_in_the_place_of_an_axis_is_refused_by_name(arm: BoundPlant, log: RunLog) -> None:
    exchanged = replace(log, u=log.y, y=log.u)
    with pytest.raises(BadInput, match=r"u_V and theta_rad stand in each other's place.*exchange u_V and theta_rad"):
        demand(examine([exchanged], arm, names=["log"]), OTHER_NUMBERS)


@pytest.mark.parametrize("hand", [False, True])
def test_inputs_that_stand_or_creep_beside_an_axis_are_no_exchange(arm: BoundPlant, log: RunLog, hand: bool) -> None:
    u = log.u if hand else np.sin(0.05 * np.arange(len(log.u)))[:, None]
    assert "columns" not in [found.kind for found in examine([replace(log, u=u)], arm, names=["log"]).findings]


@pytest.mark.parametrize(
    ("step", "exchanged", "told"), [(1.534e-3, True, True), (1.534e-3, False, False), (1.5e-3, True, False)]
)
def test_an_input_on_the_grid_of_an_output_that_lies_on_none_is_exchanged_with_it(
    arm: BoundPlant, log: RunLog, step: float, exchanged: bool, told: bool
) -> None:
    """Truth: a smooth command and an encoder of 4096 steps a turn; of 0.0015 rad a decimal, on which a command's digits may lie too."""
    angle = step * np.round(0.3 * np.sin(1.3 * log.t_s) / step)[:, None]
    command = 0.3 * np.sin(1.3 * log.t_s + 0.4)[:, None]
    u, y = (angle, command) if exchanged else (command, angle)
    own = bind(replace(arm.plant, sensors={"theta_rad": step}))
    found = [entry.sentence for entry in examine([replace(log, u=u, y=y)], own, names=["log"]).refusals]
    assert any("u_V lies on the grid of theta_rad's sensor, 0.001534 rad" in sentence for sentence in found) is told


def test_an_axis_that_moves_by_single_steps_of_its_encoder_is_no_command(arm: BoundPlant, log: RunLog) -> None:
    """Truth: an axis that creeps to and fro over three steps, each for a second, under an input that moves all along."""
    step = arm.plant.sensors["theta_rad"]
    y = step * np.round(1.5 * np.sin(2.0 * log.t_s))[:, None]
    u = np.sin(5.0 * log.t_s)[:, None]
    assert "columns" not in [entry.kind for entry in examine([replace(log, u=u, y=y)], arm, names=["log"]).findings]


def test_a_first_reading_made_before_the_sensor_was_ready_is_left_out(arm: BoundPlant, log: RunLog) -> None:
    """Truth: one reading of 3 rad in front of an axis at rest."""
    y = log.y.copy()
    y[0] = 3.0
    (found,) = [entry for entry in examine([replace(log, y=y)], arm, names=["log"]).findings if entry.kind == "glitch"]
    assert (found.rows, found.start_s) == (1, 0.0)


@pytest.mark.parametrize(("decimals", "told"), [(9, False), (2, True)])
def test_a_fixed_number_of_decimals_far_coarser_than_the_sensor_is_told(
    arm: BoundPlant, log: RunLog, decimals: int, told: bool
) -> None:
    """Truth: an encoder of 10 million steps a turn, written to a hundredth of a radian."""
    fine = bind(replace(arm.plant, sensors={"theta_rad": 6e-7}))
    rounded = replace(log, y=np.round(log.y + 1e-3 * np.sin(np.arange(len(log.y)))[:, None], decimals))
    kinds = [found.kind for found in examine([rounded], fine, names=["log"]).findings]
    assert ("other_grid" in kinds) is told


@pytest.mark.parametrize(("rows", "kind"), [(200, "begins_alike"), (800, "holdout_overlap")])
def test_a_hold_out_that_begins_as_a_training_run_does_is_no_copy_of_it(
    arm: BoundPlant, log: RunLog, rows: int, kind: str
) -> None:
    """Truth: the first tenth of 2001 rows is the same manoeuvre from rest without noise; two fifths are a copy."""
    t_s = log.t_s
    u = 0.3 * np.sin(9.0 * t_s)[:, None]
    y = 0.1 * np.cos(7.0 * t_s)[:, None]
    u[:rows], y[:rows] = log.u[:rows] + np.sin(t_s[:rows])[:, None], log.y[:rows] + np.cos(t_s[:rows])[:, None]
    trained = replace(log, u=log.u + np.sin(t_s)[:, None], y=log.y + np.cos(t_s)[:, None])
    found = duplicate_findings([trained], ["log"], [replace(log, u=u, y=y)], ["held"])
    assert [entry.finding.kind for _, entry in found] == [kind]


@pytest.mark.parametrize(("size", "told"), [(2.0 * np.pi, "a turn"), (65536 * 0.0005, "65536 counts")])
def test_an_angle_that_is_kept_within_a_turn_or_a_counter_is_refused_with_what_counts_it_on(
    arm: BoundPlant, log: RunLog, size: float, told: str
) -> None:
    """Truth: ten turns in 20 s, or forty metres' worth of counts; counted on, nothing is said of it."""
    step = 0.0005
    fine = bind(replace(arm.plant, sensors={"theta_rad": step}))
    way = (3.0 * log.t_s + np.sin(log.t_s))[:, None] * (1.0 if told == "a turn" else 4.0)
    whole, kept = (step * np.round(y / step) for y in (way, np.mod(way, size)))
    with pytest.raises(BadInput, match=f"theta_rad leaps by {told} .*`twinlaw import` counts it on"):
        demand(examine([replace(log, y=kept)], fine, names=["log"]))
    assert "wrapped" not in [found.kind for found in examine([replace(log, y=whole)], fine, names=["log"]).findings]


def test_a_sensor_of_a_coarse_grid_beside_a_smooth_input_is_no_exchange(arm: BoundPlant, log: RunLog) -> None:
    # Truth: an axis that swings through five steps of 0.06 rad under an input that is smooth.
    t_s = log.t_s
    angle = 0.16 * np.sin(0.6 * t_s)[:, None]
    coarse = replace(log, u=2.0 + np.sin(1.7 * t_s)[:, None], y=0.06 * np.round(angle / 0.06))
    demand(examine([coarse], arm, names=["log"]))


def test_an_angle_that_leaps_by_other_than_turns_too_was_not_kept_within_one() -> None:
    # Truth: 0 to 9 rad, written within a turn; and the same with a reading that goes on 2 rad away from the middle on.
    log = log_of()
    truth = 9.0 * np.linspace(0.0, 1.0, len(log.t_s))
    for leap_rad, kinds in ((0.0, ["wrapped"]), (2.0, [])):
        y = log.y.copy()
        y[:, 0] = (truth + leap_rad * (log.t_s > 5.0)) % (2.0 * np.pi)
        found = wrap_findings(replace(log, y=y), "a", STEPS, ("psi_rad",))
        assert [entry.finding.kind for entry in found] == kinds
