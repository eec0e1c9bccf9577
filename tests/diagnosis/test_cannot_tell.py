"""Logs that show too little: the verdict says so, and the notes say what could not have been seen, where, and how large it could be."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import Material, diagnose
from diagnosis.explain.sentences import sentence
from records.diagnosis import Diagnosis
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import log_columns
from sim.equilibrium import equilibrium
from sim.loop import closed_loop_log
from sim.manoeuvres import Manoeuvre
from sim.simulate import Conditions, simulate
from tests.diagnosis.arm import PERIOD_S, arm
from tests.law_tables import ce150_table

T_S = 0.01 * np.arange(1500)


def flown(plant: BoundPlant, reference: np.ndarray, locked: tuple[str, ...] = ()) -> RunLog:
    """The stated plant along a reference."""
    x0 = equilibrium(plant, 0.0).x0
    run = simulate(plant, T_S, x0, ce150_table(), Conditions(reference=reference, keep="uy", locked=locked))
    assert run.u is not None
    assert run.y is not None
    log = closed_loop_log(plant, Manoeuvre("m", T_S, reference, x0), run.u, run.y, None)
    return replace(log, extra={}, locked=locked)


def diagnosed(plant: BoundPlant, log: RunLog) -> Diagnosis:
    """The diagnosis, with every warning an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        return diagnose(plant, Material([log], [], [], [None])).diagnosis


@pytest.fixture(scope="module")
def standing() -> Diagnosis:
    """Twelve seconds in which an arm moves by one count."""
    rest = equilibrium(arm(), 0.3)
    t_s = PERIOD_S * np.arange(1200)
    u = (rest.u0[0] + 0.003 * np.sin(t_s))[:, None]
    y = np.asarray(simulate(arm(), t_s, rest.x0, u, Conditions(keep="y")).y).reshape(len(t_s), -1)
    return diagnosed(arm(), RunLog(log_columns(arm().model), PERIOD_S, "open", t_s, u, y))


def test_an_arm_that_hardly_moves_cannot_tell_and_says_what_went_unseen(standing: Diagnosis) -> None:
    # Truth: a drag with the square of a speed of 0.1 deg/s, and a lag of what is hardly changed, leave no trace.
    assert (standing.verdict, standing.found) == ("cannot tell", ())
    assert any("effects of the library would go unseen" in note for note in standing.notes)
    unseen = [note for note in standing.note_records if note.kind == "unseen"]
    told = {note.subject: sentence(note) for note in unseen}
    assert "quadratic_drag" in told["arm"].split(" of any size")[0]
    assert any(" below width = " in text for text in told.values())
    assert len(told) == len(unseen)
    assert len([note for note in standing.note_records if note.kind == "imitated"]) == 1
    assert tuple(map(sentence, standing.note_records)) == standing.notes


def test_the_run_to_record_next_moves_the_arm_more(standing: Diagnosis) -> None:
    shown, now = counts(standing)
    assert shown > 2 * now


def counts(diagnosis: Diagnosis) -> tuple[int, int]:
    """How many effects show in the run to record next, which is within limits, and how many do now."""
    told = diagnosis.next_experiment
    assert told is not None
    assert told["within_limits"]
    shown, now = zip(told["expected_outcome"].split("; "), (0, 3), strict=True)
    return int(shown[0].split()[shown[1]]), int(now[0].split()[now[1]])


@pytest.fixture(scope="module")
def hover(plant: BoundPlant) -> Diagnosis:
    """Fifteen seconds in which each axis moves by two or three counts."""
    return diagnosed(plant, flown(plant, np.column_stack([0.003 * np.sin(T_S), 0.004 * np.sin(0.7 * T_S)])))


@pytest.mark.soak
def test_a_rig_that_hardly_moves_cannot_tell(hover: Diagnosis) -> None:
    assert hover.verdict == "cannot tell"
    assert hover.found == ()
    assert any("effects of the library would go unseen" in note for note in hover.notes)


@pytest.mark.soak
def test_the_run_to_record_next_is_one_that_shows_more(hover: Diagnosis) -> None:
    # Truth: whatever is flown moves the rig more than a hover of two counts, so more effects show than do now.
    shown, now = counts(hover)
    assert shown > 2 * now + 10


@pytest.mark.soak
def test_what_went_unseen_is_told_by_place_with_its_size(hover: Diagnosis) -> None:
    # Truth: a drag with the square of a speed of 0.2 deg/s, and a stop never reached, leave no trace at any size; a delay does.
    unseen = [note for note in hover.note_records if note.kind == "unseen"]
    told = {note.subject: sentence(note) for note in unseen}
    assert {"azimuth", "elevation", "tail_input"} <= set(told)
    never = told["azimuth"].split(" of any size")[0]
    assert "quadratic_drag" in never
    assert "upper_stop" in never
    assert any(" below tau = " in text for text in told.values())
    assert len(told) == len(unseen)
    assert len([note for note in hover.note_records if note.kind == "imitated"]) == 1
    # Truth: a rotor turns six radians from row to row, from where nobody knows.
    (unfollowed,) = [note for note in hover.note_records if note.kind == "unfollowed"]
    assert unfollowed.numbers["effects"] == ["main_rotor.imbalance", "tail_rotor.imbalance"]
    assert tuple(map(sentence, hover.note_records)) == hover.notes


@pytest.mark.soak
def test_a_locked_axis_shows_nothing_of_itself(plant: BoundPlant) -> None:
    # Truth: the elevation is held, so no effect on it can have moved anything; the azimuth's delay would have been seen.
    reference = np.column_stack([np.zeros(len(T_S)), 0.6 * np.sin(0.7 * T_S)])
    diagnosis = diagnosed(plant, flown(plant, reference, ("elevation",)))
    assert diagnosis.verdict in ("no gap", "cannot tell")
    assert diagnosis.found == ()
    unseen = {note.subject: note.numbers for note in diagnosis.note_records if note.kind == "unseen"}
    for kind in ("quadratic_drag", "cable_spring", "centre_of_gravity"):
        assert unseen["elevation"][kind] is None  # of any size
    assert "delay" not in unseen.get("tail_input", {})
