"""A log whose last part is no flight: the rig off, or its sensor no longer read."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from logcheck.facts import plant_facts
from logcheck.integrity import examine
from logcheck.stands.foretold import foretold_findings
from logcheck.stands.standing import end_findings, off_findings
from logcheck.stretches import part
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import log_columns
from tests.logcheck.flight import clean, plant
from tests.logcheck.test_parts import PLANT, STEP_RAD, STEPS, log_of, rounded
from tests.own_plants import BOAT
from twinlaw import fly, load

OFF = 1334  # of 2001 rows: two thirds


def kinds(arm: BoundPlant, log: RunLog) -> dict[str, float]:
    """Kinds of what is left out of a log, and from when."""
    found = examine([log], arm, names=["log"]).findings
    return {entry.kind: entry.start_s for entry in found if entry.severity == "exclude"}


def test_nothing_is_said_of_a_log_that_ends_as_it_began(arm: BoundPlant) -> None:
    log = fly(arm)
    for rows in range(400, 2001, 100):
        assert kinds(arm, replace(log, t_s=log.t_s[:rows], u=log.u[:rows], y=log.y[:rows])) == {}


def test_an_output_that_stands_to_the_end_under_moving_inputs_is_left_out_from_there(arm: BoundPlant) -> None:
    """Truth: the last reading is that of row 1400, at which the arm rests, so that no jump tells of the stand."""
    log = fly(arm)
    slow = int(np.argmin(np.abs(np.diff(log.y[1200:1500, 0])))) + 1200
    y = log.y.copy()
    y[slow:] = y[slow]
    found = kinds(arm, replace(log, y=y))
    assert found
    assert min(found.values()) == pytest.approx(log.t_s[slow], abs=0.2)


def test_a_rig_that_was_switched_off_is_left_out_from_there(arm: BoundPlant) -> None:
    log = fly(arm)
    far = int(np.argmax(np.abs(log.y[OFF:1700, 0]))) + OFF
    u, y = log.u.copy(), log.y.copy()
    u[far:], y[far:] = 0.0, 0.0
    assert kinds(arm, replace(log, u=u, y=y))["switched_off"] == pytest.approx(log.t_s[far])


def test_an_axis_that_stands_at_an_end_of_its_range_may_be_stopped_and_what_no_mass_moves_may_not() -> None:
    """Truth: from its largest reading on psi stands, though the inputs go on as before."""
    log = log_of()
    y, top = log.y.copy(), int(np.argmax(log.y[:1600, 0]))
    y[top:, 0] = y[top, 0]
    stands, begins = replace(log, y=y), np.zeros(len(log.t_s), bool)
    assert [found.finding.kind for found in end_findings(stands, "a", STEPS, begins)] == ["dead_end"]
    assert list(end_findings(stands, "a", STEPS, begins, ("psi_rad",))) == []


def test_an_output_may_stand_where_only_inputs_move_that_do_not_move_it(tmp_path: Path) -> None:
    """Truth: a boat that holds its speed to the last count while its rudder goes to and fro; its propeller's thrust stays as it is."""
    boat = load(str(BOAT.write(tmp_path, "boat")))
    assert plant_facts(boat).moved_by == {"v_m_s": {"thrust_N"}, "psi_rad": {"thrust_N", "rudder_rad"}}
    t_s = 0.01 * np.arange(2000)
    thrust_N = np.where(t_s < 10.0, 20.0 * (t_s // 1.0 % 2), 10.0)
    rudder_rad = 0.3 * (t_s // 1.0 % 2)
    v_m_s = np.where(t_s < 10.0, 0.1 * thrust_N, 1.0)
    u, y = np.column_stack([thrust_N, rudder_rad]), np.column_stack([v_m_s, 0.1 * np.sin(t_s)])
    log, begins = RunLog(log_columns(boat.model), 0.01, "closed", t_s, u, y), np.zeros(t_s.size, bool)
    assert [found.finding.column for found in end_findings(log, "a", {}, begins)] == ["v_m_s"]
    assert list(end_findings(log, "a", {}, begins, (), plant_facts(boat).moved_by)) == []


@pytest.mark.parametrize(("rows", "told"), [(100, False), (400, True)])
def test_an_output_that_answers_late_is_given_three_times_as_long(rows: int, told: bool) -> None:
    """Truth: psi follows its input 60 rows later, all along; it has not answered the last of its switches."""
    k = np.arange(1800 + rows)
    u_V = 2.0 * ((np.minimum(k, 1800) // 200) % 2)
    psi = 0.1 * np.where(k < 60, 0.0, u_V[np.maximum(k - 60, 0)])
    psi[1800:] = psi[1799]
    log = log_of(len(k))
    late = replace(log, u=np.column_stack([u_V, u_V]), y=np.column_stack([psi, log.y[:, 1]]))
    found = [entry.finding.column for entry in end_findings(late, "a", STEPS, np.zeros(len(k), bool))]
    assert ("psi_rad" in found) == told


def test_a_log_that_ends_at_rest_behind_a_move_that_its_axis_often_makes_was_not_switched_off() -> None:
    """Truth: an axis that moves by up to 13 steps a row comes to rest by single steps and a last one of 10; then nothing changes."""
    log = log_of()
    u, y = log.u.copy(), log.y.copy()
    y[:, 0] = rounded(0.5 * np.sin(4.0 * log.t_s))
    y[1900:1990, 0] = y[1899, 0] + STEP_RAD * np.arange(1, 91)
    y[1990:, 0] = y[1989, 0] + 10 * STEP_RAD
    y[1990:, 1], u[1990:] = y[1989, 1], u[1989]
    rest = replace(log, u=u, y=y)
    assert list(off_findings(rest, "a", PLANT, STEPS)) == []
    y[1990:, 0] = y[1989, 0] + 60 * STEP_RAD
    assert [found.finding.kind for found in off_findings(replace(rest, y=y), "a", PLANT, STEPS)] == ["switched_off"]


def test_a_recorder_that_stood_is_told_by_an_axis_that_leaps_with_the_next_command(arm: BoundPlant) -> None:
    """Truth: nothing was written from row 900 to row 1000, where the arm rested, and meanwhile the input stepped and the arm followed."""
    log = fly(arm)
    rest, away = log.y[0, 0], 100.0 * arm.plant.sensors["theta_rad"]
    y, u = np.full_like(log.y, rest), np.full_like(log.u, 1.0)
    y[:300, 0] += 0.5 * away * np.sin(0.05 * np.arange(300))
    y[1000:, 0] = np.round((rest + away) / arm.plant.sensors["theta_rad"]) * arm.plant.sensors["theta_rad"]
    u[1000:] = 2.0
    stood = replace(log, y=y, u=u, loop="open")
    (found,) = [entry for entry in examine([stood], arm, names=["a"]).findings if entry.kind == "dead_stretch"]
    assert found.end_s == pytest.approx(log.t_s[999])
    (looked,) = examine([stood], arm, names=["a"]).logs
    assert np.flatnonzero(looked.begins).tolist() == [1000]


def test_an_output_that_is_read_no_more_from_its_rest_on_is_told_by_what_the_plant_foretells_and_a_rest_is_not() -> (
    None
):
    """Truth: psi rests from row 827 to the step of its reference at row 900; in one log it is read no more from there on."""
    log, facts, none = clean(), plant_facts(plant()), np.zeros(len(clean().t_s), bool)
    y = log.y.copy()
    y[827:, 0] = y[827, 0]
    (found,) = foretold_findings(replace(log, y=y), "a", plant(), facts, none)
    assert (found.finding.column, found.finding.start_s) == ("psi_rad", pytest.approx(log.t_s[827]))
    assert list(foretold_findings(part(log, slice(0, 882)), "a", plant(), facts, none[:882])) == []


def test_a_range_that_ends_where_an_axis_is_held_beyond_it_is_told_by_what_the_plant_foretells() -> None:
    """Truth: psi is read down to -0.3 rad, and from 5.3 s to 9.3 s the flight holds it at -0.42 rad."""
    log, facts, none = clean(), plant_facts(plant()), np.zeros(len(clean().t_s), bool)
    level = log.y[np.argmin(np.abs(log.y[:, 0] + 0.3)), 0]
    y = log.y.copy()
    y[:, 0] = np.maximum(y[:, 0], level)
    (found,) = foretold_findings(replace(log, y=y), "a", plant(), facts, none)
    assert (found.finding.kind, found.finding.column) == ("clipped_sensor", "psi_rad")
    assert found.excluded is not None
    np.testing.assert_array_equal(found.excluded, log.y[:, 0] <= level)
    assert list(foretold_findings(log, "a", plant(), facts, none)) == []


def test_a_leap_out_of_a_stand_of_a_sensor_is_no_other_recording() -> None:
    """Truth: from 8.2 s to 8.7 s the carriage of an open loop is not read, at 0.3 m/s; it is one recording."""
    carriage = load("plants/emps.toml")
    log = fly(carriage)
    y = log.y.copy()
    y[820:870] = y[820]
    found = [entry.kind for entry in examine([replace(log, y=y)], carriage, names=["log"]).findings]
    assert "dead_stretch" in found
    assert "seam" not in found
