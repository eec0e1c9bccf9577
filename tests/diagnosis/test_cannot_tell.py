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
from sim.equilibrium import equilibrium
from sim.loop import closed_loop_log
from sim.manoeuvres import Manoeuvre
from sim.simulate import simulate
from tests.law_tables import ce150_table
from tests.soak import SOAK

T_S = 0.01 * np.arange(1500 if SOAK else 1200)


def flown(plant: BoundPlant, reference: np.ndarray, locked: tuple[str, ...] = ()) -> RunLog:
    """The stated plant along a reference."""
    x0 = equilibrium(plant, 0.0).x0
    run = simulate(plant, T_S, x0, ce150_table(), reference=reference, keep="uy", locked=locked)
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
def hover(plant: BoundPlant) -> Diagnosis:
    """Twelve seconds or more in which each axis moves by two or three counts."""
    return diagnosed(plant, flown(plant, np.column_stack([0.003 * np.sin(T_S), 0.004 * np.sin(0.7 * T_S)])))


def test_a_rig_that_hardly_moves_cannot_tell(hover: Diagnosis) -> None:
    assert hover.verdict == "cannot tell"
    assert hover.found == ()
    assert any("effects of the library would go unseen" in note for note in hover.notes)


def test_the_run_to_record_next_is_one_that_shows_more(hover: Diagnosis) -> None:
    # Truth: whatever is flown moves the rig more than a hover of two counts, so more effects show than do now.
    told = hover.next_experiment
    assert told is not None
    shown, now = (
        int(part.split()[index]) for part, index in zip(told["expected_outcome"].split("; "), (0, 3), strict=True)
    )
    assert shown > 2 * now + 10
    assert told["within_limits"]


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
