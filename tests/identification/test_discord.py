"""Logs of one rig agree; logs of two rigs are told apart, by log and by parameter."""

from dataclasses import replace

import pytest

from identification.belief import NOTHING
from identification.bench import task
from identification.estimate import estimate
from identification.log_run import log_run
from identification.notes import stage_notes
from identification.ranges import ranges_of
from sim.bind import bind

NAMES = ("J_A", "b_vA", "J_E")


@pytest.fixture(scope="module")
def other(bound):
    """A rig whose azimuth has a fifth more inertia."""
    J_A = bound.plant.parameters["J_A"]
    return bind(replace(bound.plant, parameters={**bound.plant.parameters, "J_A": replace(J_A, value=1.2 * J_A.value)}))


def run_of(rig, seed, nominal):
    """Thirty seconds of a flight of that rig, as a run of the nominal plant."""
    work = task(rig, seed)
    log = replace(work.log, t_s=work.log.t_s[:3000], u=work.log.u[:3000], y=work.log.y[:3000])
    return log_run(nominal, log, f"log {seed}", 5.0, at_first=work.x0)


def test_logs_of_one_rig_agree(bound):
    found = estimate([run_of(bound, seed, bound) for seed in (1, 2, 3)], NAMES, ranges_of(bound, NAMES), NOTHING)
    assert found.discords == ()


def test_the_log_of_another_rig_is_named_with_its_parameter(bound, other):
    """Two of one rig and one of the other: that one says 1.2 times the inertia, by at least five sd, and it alone is named."""
    runs = [run_of(bound, 1, bound), run_of(other, 2, bound), run_of(bound, 3, bound)]
    found = estimate(runs, NAMES, ranges_of(bound, NAMES), NOTHING)
    first = found.discords[0]
    assert (first.run, first.name) == ("log 2", "J_A")
    assert first.own / first.others == pytest.approx(1.2, rel=0.05)
    assert any("log 2 contradicts the others in J_A" in note for note in stage_notes("three logs", found))


def test_two_logs_that_contradict_each_other_are_told_once(bound, other):
    runs = [run_of(bound, 1, bound), run_of(other, 2, bound)]
    found = estimate(runs, NAMES, ranges_of(bound, NAMES), NOTHING)
    assert [entry.name for entry in found.discords] == ["J_A"]
