"""Window starts eliminated from the normal equations, against the whole system written out, and against the cost that they minimise."""

from dataclasses import replace

import numpy as np
import pytest

from identification.fit import solve as solver
from identification.fit.belief import NOTHING
from identification.fit.normal_equations import at, reduced
from identification.fit.problem import Prior
from identification.fit.ranges import ranges_of
from identification.fit.solve import solve
from identification.proof.bench import task
from identification.runs.log_run import log_run
from identification.runs.run import coefficient_names, with_starts
from identification.stages.estimate import problem_of
from tests.identification.flights import cut

NAMES = ("J_E", "b_vE", "K_M")


@pytest.fixture(scope="module")
def problem(bound):
    """Windows of 5 s over half a minute without the rounding's leaps, prior knowledge that pulls, starts moved off their guess."""
    work = task(bound)
    run = log_run(bound, cut(work.log, 0.0, 30.0), "log", 5.0, at_first=work.x0)
    asked = problem_of((run,), NAMES, ranges_of(bound, NAMES), NOTHING)
    truth = bound.p[[coefficient_names(bound.model).index(name) for name in NAMES]]
    known = Prior(1.02 * truth, np.diag(1.0 / (0.01 * truth) ** 2))
    return replace(asked, start=1.01 * truth, prior=known, runs=(moved(run, 1),))


def moved(run, seed):
    x0 = run.x0.copy()
    places = [[str(state) for state in run.bound.model.states].index(name) for name in run.free]
    x0[:, places] += 0.1 * run.start_sd * np.random.default_rng(seed).standard_normal(run.start_sd.shape)
    return with_starts(run, x0)


def whole_system(problem, point):
    """J'J + weights and J'r over parameters and every window's starts, as one matrix without any elimination."""
    (run,), (own,) = point.runs, point.blocks
    free, k = len(run.free), len(problem.names)
    J = np.zeros((run.y.size, k + free * len(own)))
    for number, block in enumerate(own):
        J[block.place, :k] = block.by_parameter
        J[block.place, k + free * number : k + free * (number + 1)] = block.by_start
    residual = np.concatenate([block.residual for block in own])
    places = [[str(state) for state in run.bound.model.states].index(name) for name in run.free]
    away = (run.x0 - run.guess)[:, places].ravel()
    weight = 1.0 / run.start_sd.ravel() ** 2
    A, b = J.T @ J, J.T @ residual
    A[:k, :k] += problem.prior.information
    A[k:, k:] += np.diag(weight)
    b[:k] += problem.prior.information @ (problem.prior.mean - point.theta)
    b[k:] -= weight * away
    return A, b, places


def test_the_step_is_that_of_the_whole_system(problem):
    point = at(problem, problem.start, problem.runs)
    A, b, places = whole_system(problem, point)
    size = np.sqrt(np.diag(A))
    step = np.linalg.solve(A / np.outer(size, size), b / size) / size
    theta, (run,), length = solver._step(problem, point, 0.0)
    k = len(NAMES)
    np.testing.assert_allclose(theta - point.theta, step[:k], rtol=1e-6)
    np.testing.assert_allclose((run.x0 - point.runs[0].x0)[:, places].ravel(), step[k:], rtol=1e-5, atol=1e-9)
    assert np.sqrt(length) > 1.0  # there is something to move


def minimised(problem, theta):
    """The cost with the parameters held at theta and every start where it is least."""
    held = replace(problem, start=theta, lower=theta, upper=theta)
    return solve(held, settled=1e-12)


def test_gradient_and_curvature_are_those_of_the_cost_that_the_starts_minimise(problem):
    """dV = -2 (g + prior) and, near the truth, where residuals are small, d2V = 2 (H + prior), by differences."""
    theta = problem.start * 1.0005 / 1.01
    here = minimised(problem, theta)
    g = reduced(here, 0.0)[1] + problem.prior.information @ (problem.prior.mean - theta)
    A = here.H + problem.prior.information
    assert A[2, 2] < 0.8 * here.JtJ[2, 2]  # the starts take a good part of what the readings tell
    for place, name in enumerate(NAMES):
        step = 1e-4 * theta * (np.arange(len(NAMES)) == place)
        above, below = (minimised(problem, theta + sign * step).cost for sign in (1.0, -1.0))
        h = step[place]
        assert (above - below) / (2.0 * h) == pytest.approx(-2.0 * g[place], rel=2e-3), name
        assert (above + below - 2.0 * here.cost) / h**2 == pytest.approx(2.0 * A[place, place], rel=0.03), name
