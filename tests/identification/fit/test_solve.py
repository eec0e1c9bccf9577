"""The least-squares solver: it finds what is there from far off, keeps bounds and prior, and says what cannot be told."""

from dataclasses import replace

import numpy as np
import pytest

from identification.fit.belief import NOTHING, Belief
from identification.fit.normal_equations import _starts
from identification.fit.ranges import Range, ranges_of
from identification.fit.solve import _informed_step, solve
from identification.proof import bench
from identification.runs.log_run import log_run
from identification.runs.prediction import blocks
from identification.runs.run import coefficient_names
from identification.stages.estimate import estimate, problem_of
from identification.stages.weights import by_channel
from records.errors import BadInput
from tests.own_plants import NO_AXIS
from tests.soak import sampled
from twinlaw import fly, load


@pytest.fixture(scope="module")
def work(bound):
    return bench.task(bound)


@pytest.mark.parametrize("seed", sampled([0, 1, 2], keep=[0]))
@pytest.mark.parametrize("way", [bench.fit, bench.identified])
def test_ten_parameters_from_a_minute_come_back_within_a_thousandth_from_thirty_per_cent_off(work, way, seed):
    tolerance = 1e-3
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], work.truth.size)
    found = way(replace(work, start=work.truth * (1.0 + bench.OFF * signs)))
    assert np.max(np.abs(found / work.truth - 1.0)) < tolerance


def test_a_parameter_stays_within_its_bounds_and_the_others_follow(bound, work):
    """J_E may not fall below 1.1 times the truth: it ends there."""
    names = ("J_E", "b_vE")
    places = [coefficient_names(bound.model).index(name) for name in names]
    ranges = ranges_of(bound, names)
    least = 1.1 * bound.p[places[0]]
    ranges["J_E"] = Range(1.2 * bound.p[places[0]], least, 2.0 * bound.p[places[0]], bound.p[places[0]])
    runs = (log_run(bound, work.log, "log", 2.0, at_first=work.x0),)
    point = solve(problem_of(runs, names, ranges, NOTHING))
    assert point.theta[0] == pytest.approx(least, rel=1e-9)
    assert point.theta[1] != pytest.approx(bound.p[places[1]], rel=1e-3)


def test_what_was_known_counts_as_so_many_data(bound, work):
    """Two halves of a log one after another give what the whole gives at once, to a small part of its sd."""
    names = ("J_E", "tau_gE", "b_vE", "J_A", "b_vA")
    run = log_run(bound, work.log, "whole", 2.0, at_first=work.x0)
    ranges = ranges_of(bound, names)
    whole = solve(problem_of((run,), names, ranges, NOTHING))
    halves = [
        replace(
            run, y=run.y[part], sd=run.sd[part], at_s=run.at_s[part], channel=run.channel[part], select=run.select[part],
            begins=run.begins[rows], stops=run.stops[rows], x0=run.x0[rows], start_sd=run.start_sd[rows],
        )
        for rows, part in _halves(run)
    ]  # fmt: skip
    first = solve(problem_of((halves[0],), names, ranges, NOTHING))
    weak = np.diag([1.0 / ranges[name].scale ** 2 for name in names])
    known = Belief(names, first.theta, np.linalg.inv(first.H + weak))
    second = solve(problem_of((halves[1],), names, ranges, known))
    sd = np.sqrt(np.diag(np.linalg.inv(whole.H)))
    assert np.all(np.abs(second.theta - whole.theta) < 0.1 * sd)
    np.testing.assert_allclose(np.diag(first.H + second.H), np.diag(whole.H), rtol=1e-2)


def _halves(run):
    middle = len(run.begins) // 2
    edge = int(np.searchsorted(run.select, run.begins[middle] * run.outputs))
    return ((slice(0, middle), slice(0, edge)), (slice(middle, None), slice(edge, None)))


def test_a_common_scale_of_all_torques_is_named_as_a_direction_that_cannot_be_told(bound, work):
    """Inertia, gravity, friction and thrust of an axis show in the motion by their ratios alone."""
    names = ("J_E", "tau_gE", "b_vE", "b_cE", "l_M", "K_E")
    run = log_run(bound, work.log, "log", 5.0, at_first=work.x0)
    found = estimate([run], names, ranges_of(bound, names), NOTHING)
    (blind,) = found.unseen
    np.testing.assert_allclose([weight for _, weight in blind.weights], 1.0 / np.sqrt(6.0), rtol=0.01)
    assert {name for name, _ in blind.weights} == set(names)
    ratio = found.belief.value("J_E") / found.belief.value("tau_gE")
    assert ratio == pytest.approx(bound.parameter("J_E") / bound.parameter("tau_gE"), rel=2e-3)


def test_an_axis_that_never_moves_tells_nothing_of_its_inertia(bound, work):
    log = replace(work.log, u=np.zeros_like(work.log.u), y=np.tile([-0.7853, 0.0], (work.log.t_s.size, 1)))
    found = estimate([log_run(bound, log, "rest", 5.0)], ("J_A",), ranges_of(bound, ("J_A",)), NOTHING)
    assert [name for direction in found.unseen for name, _ in direction.weights] == ["J_A"]


def test_data_that_contradict_are_told_by_parameter(bound, work):
    places = coefficient_names(bound.model).index("J_A")
    wrong = Belief(("J_A",), 1.2 * bound.p[[places]], np.array([[(1e-3 * bound.p[places]) ** 2]]))
    run = log_run(bound, work.log, "log", 5.0, at_first=work.x0)
    found = estimate([run], ("b_vA",), ranges_of(bound, ("J_A", "b_vA")), wrong)
    assert [entry.name for entry in found.contradictions] == ["J_A"]
    assert found.contradictions[0].sds > 5.0


def test_a_start_outside_its_bounds_or_an_unknown_name_is_refused(bound):
    with pytest.raises(
        BadInput, match=r"start of J_E: got 0.00437, expected a value between its bounds 0.005 and 0.006"
    ):
        ranges_of(bound, ("J_E",), {"J_E": (0.005, 0.006)})
    with pytest.raises(BadInput, match="parameter 'J_X'"):
        ranges_of(bound, ("J_X",))


@pytest.mark.parametrize(("slope", "expected"), [(1.2, 0.0), (30.0, 20.0)])
def test_a_direction_of_which_the_data_know_nothing_is_left_unless_it_promises_a_lot(slope, expected):
    """Information 1e6 on the sum of two parameters, 1.5 on their difference: the sum takes its step of 1e-3 in either case."""
    V = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0)
    A = V @ np.diag([1e6, 1.5]) @ V
    step = _informed_step(A, A, V @ np.array([1e3, slope]), np.ones(2))
    np.testing.assert_allclose(V @ step, [1e-3, expected], rtol=1e-9, atol=1e-12)


def test_a_start_from_which_no_motion_comes_back_is_given_back(bound, work):
    """A reaction of 1e150 N m s leaves the range of numbers within a sample."""
    log = replace(work.log, t_s=work.log.t_s[:50], u=work.log.u[:50], y=work.log.y[:50])
    run = log_run(bound, log, "log", 2.0, at_first=work.x0)
    point = solve(problem_of((run,), ("K_A",), {"K_A": Range(1e150, 0.0, 1e151, 1e150)}, NOTHING))
    assert point.theta.tolist() == [1e150]
    assert point.steps == 0


def test_residuals_whose_squares_leave_the_range_of_numbers_still_weigh_readings(bound, work):
    """1e200 times what the readings were worth: their sd is that many times larger then, and of an infinite one as it was."""
    run = log_run(bound, work.log, "log", 5.0, at_first=work.x0)
    point = solve(problem_of((run,), ("J_A",), ranges_of(bound, ("J_A",)), NOTHING))
    for size, times in ((1e200, 1e200), (np.inf, 1.0)):
        far = tuple(replace(block, residual=np.full_like(block.residual, size)) for block in point.blocks[0])
        (weighed,) = by_channel(None, replace(point, blocks=(far,)))
        np.testing.assert_allclose(weighed.sd, run.sd * times, rtol=1e-12)


def test_a_fit_whose_start_no_run_can_be_compared_with_is_refused(bound, work):
    """A friction of -1e20 N m s drives the axis out of the range of numbers within a sample."""
    log = replace(work.log, t_s=work.log.t_s[:50], u=work.log.u[:50], y=work.log.y[:50])
    run = log_run(bound, log, "log", 2.0, at_first=work.x0)
    with pytest.raises(
        BadInput, match=r"log: start of a fit: got a motion that leaves the range of numbers, with b_vA"
    ):
        estimate([run], ("b_vA",), {"b_vA": Range(-1e20, -1e21, 0.1, 1e20)}, NOTHING)


def test_starts_whose_slopes_have_grown_past_all_digits_can_still_be_solved_for(work):
    """All slopes by the start 1e16, so that its states look alike; without the mend LinAlgError from the impulses of a real rig."""
    run = log_run(work.bound, work.log, "log", 5.0, at_first=work.x0)
    grown = tuple(replace(block, by_start=np.full_like(block.by_start, 1e16)) for block in blocks(run, (), np.zeros(0)))
    C = _starts(run, grown).C
    assert np.all(np.isfinite(np.linalg.solve(C, C)))
    assert np.all(np.linalg.cond(C) < 1e14)


def test_a_start_that_is_faster_than_the_stated_plant_is_followed_in_as_many_steps_as_it_needs(tmp_path):
    """Truth: L = 0.1 V s/A. From 1 mV s/A a step of 10 ms is 20 time constants, of which Runge and Kutta follow 2.8 at once."""
    coil = load(str(NO_AXIS.write(tmp_path, "coil")))
    log = fly(coil)
    brief = replace(log, t_s=log.t_s[:400], u=log.u[:400], y=log.y[:400])
    found = estimate([log_run(coil, brief, "log", np.inf)], ("L",), {"L": Range(1e-3, 1e-4, 1.0, 0.1)}, NOTHING)
    assert abs(found.belief.value("L") - 0.1) < 1e-3
