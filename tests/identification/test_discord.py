"""Logs of one rig agree; logs of two rigs are told apart, by log and by parameter."""

from dataclasses import replace

import pytest

from identification.fit.belief import NOTHING
from identification.fit.ranges import ranges_of
from identification.proof.bench import task
from identification.results.notes import stage_notes
from identification.runs.log_run import log_run
from identification.stages.estimate import Data, estimate
from identification.stages.logs import identify_logs
from sim.loop import fly_law
from sim.manoeuvres import flight
from tests.identification.flights import cut, off
from tests.soak import sampled

NAMES = ("J_A", "b_vA", "J_E")


@pytest.fixture(scope="module")
def other(bound):
    """A rig whose azimuth has a fifth more inertia."""
    return off(bound, {"J_A": 1.2})


@pytest.fixture(scope="module")
def run_of(bound):
    """Thirty seconds of a flight of a rig, as a run of the nominal plant; each is flown once."""
    flown = {}

    def found(rig, seed):
        if (id(rig), seed) not in flown:
            flown[id(rig), seed] = _run_of(rig, seed, bound)
        return flown[id(rig), seed]

    return found


def _run_of(rig, seed, nominal):
    work = task(rig, seed)
    log = replace(work.log, t_s=work.log.t_s[:3000], u=work.log.u[:3000], y=work.log.y[:3000])
    return log_run(nominal, log, f"log {seed}", 5.0, at_first=work.x0)


def test_logs_of_one_rig_agree(bound, run_of):
    found = estimate([run_of(bound, seed) for seed in (1, 2, 3)], NAMES, ranges_of(bound, NAMES), NOTHING)
    assert found.discords == ()


def test_the_log_of_another_rig_is_named_with_its_parameter(bound, other, run_of):
    """Two of one rig and one of the other: that one says 1.2 times the inertia, by at least five sd, and it alone is named."""
    runs = [run_of(bound, 1), run_of(other, 2), run_of(bound, 3)]
    found = estimate(runs, NAMES, ranges_of(bound, NAMES), NOTHING)
    first = found.discords[0]
    assert (first.run, first.name) == ("log 2", "J_A")
    assert first.own / first.others == pytest.approx(1.2, rel=0.05)
    notes = stage_notes(Data("three logs", "three logs"), found, {"J_A": "kg m^2"})
    assert any("log 2 contradicts the others in J_A" in note and " kg m^2 by the others, " in note for note in notes)


def test_two_logs_that_contradict_each_other_are_told_once(bound, other, run_of):
    runs = [run_of(bound, 1), run_of(other, 2)]
    found = estimate(runs, NAMES, ranges_of(bound, NAMES), NOTHING)
    assert [entry.name for entry in found.discords] == ["J_A"]
    assert any(
        "log 1 contradicts log 2 in J_A" in note for note in stage_notes(Data("two logs", "two logs"), found, {})
    )


@pytest.fixture(scope="module")
def flown_by_other(other, table):
    """The project's flight of the other rig under the nominal plant's controller."""
    return fly_law(other, table, flight(other), substeps=4)


def test_closed_loops_of_two_rigs_are_told_apart_though_each_bears_the_other_s_misfit(bound, flown, flown_by_other):
    """J_A and 1.2 J_A, within 2 %; by the common fit's residuals alone, 25 times the sensors', they would be one."""
    logs = {"one": cut(flown, 64, 12), "another": cut(flown_by_other, 64, 12)}
    found = identify_logs(bound, logs, ("J_A", "b_vA", "J_E", "b_vE"))
    assert [entry.name for entry in found.discords] == ["J_A"]
    assert found.discords[0].own == pytest.approx(bound.parameter("J_A"), rel=0.02)
    assert found.discords[0].others == pytest.approx(1.2 * bound.parameter("J_A"), rel=0.02)


@pytest.mark.parametrize(("begins_s", "length_s"), sampled([((40, 64), 12), ((15, 60), 40)], keep=[((40, 64), 12)]))
def test_closed_loops_of_one_rig_agree(bound, flown, begins_s, length_s):
    """Twelve seconds explain each log whole, forty do so in windows."""
    logs = {f"from {begin_s} s": cut(flown, begin_s, length_s) for begin_s in begins_s}
    assert identify_logs(bound, logs, ("J_A", "b_vA", "J_E", "b_vE")).discords == ()
