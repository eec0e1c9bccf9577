"""The secant search against minima known by hand, and the cost (7) against its definition."""

import numpy as np
import pytest

from identification.frequency.match.cost import N_OMEGA, chosen_points, coherence_weight, good_range, residual, target
from identification.frequency.match.secant import restarted, secant_search
from identification.frequency.responses.conditioned import Responses
from tests.identification.fit.valley import valley


def test_secants_find_the_end_of_a_bent_valley_without_a_derivative():
    found = secant_search(valley, np.array([-1.2, 1.0]), np.ones(2))
    assert found is not None
    np.testing.assert_allclose(found.theta, 1.0, atol=1e-5)
    assert found.evaluations < 400


def test_a_linear_problem_is_solved_from_the_first_points():
    """12 unknowns: four sets of 12 points, each checked by a few steps, are the most that may be spent."""
    M = np.random.default_rng(1).standard_normal((30, 12))
    found = secant_search(lambda theta: M @ (theta - 3.0), np.zeros(12), np.ones(12))
    assert found is not None
    np.testing.assert_allclose(found.theta, 3.0, rtol=1e-6)
    assert found.evaluations < 120


def waves(theta):
    """(theta^2 - 1)^2 + 0.1 (theta + 1)^2 has a minimum near 1 (J = 0.39) and the deeper one, 0, at -1."""
    return np.array([theta[0] ** 2 - 1.0, np.sqrt(0.1) * (theta[0] + 1.0)])


def test_a_minimum_that_is_no_solution_is_left_by_another_start():
    stuck = secant_search(waves, np.array([2.0]), np.ones(1))
    assert stuck is not None
    assert stuck.theta[0] > 0.8
    found = restarted(waves, [np.array([2.0]), np.array([-2.0])], np.ones(1))
    assert found[0].theta[0] == pytest.approx(-1.0, abs=1e-6)
    assert found[0].J < 1e-10 < found[1].J


def test_it_keeps_to_where_there_is_an_answer():
    def beyond_two_is_nothing(theta):
        return None if theta[0] > 2.0 else np.array([theta[0] - 3.0])

    found = secant_search(beyond_two_is_nothing, np.array([0.0]), np.ones(1))
    assert found is not None
    assert 1.9 < found.theta[0] <= 2.0
    assert secant_search(beyond_two_is_nothing, np.array([5.0]), np.ones(1)) is None


def responses(coherence, T):
    omega = np.geomspace(1.0, 10.0, coherence.size)
    whole = np.asarray(coherence)[:, None, None]
    return Responses(omega, T[:, None, None], whole, whole, (), np.ones((1, *whole.shape)), ())


def test_one_dB_or_7_57_degrees_at_full_coherence_cost_twenty():
    """J = 20 / n sum W_gamma [1 dB^2]: 20 x 1.58 (1 - exp(-1)) = 19.97 for any number of points."""
    T = np.exp(1j * np.linspace(0.0, 1.0, 60))
    points = target(responses(np.ones(60), T))
    assert points.T.size == N_OMEGA
    louder, later = 10.0 ** (-1.0 / 20.0), np.exp(-1j * np.radians(7.57))
    for wrong in (louder, later):
        r = residual(points, (T * wrong)[:, None, None])
        assert float(r @ r) == pytest.approx(19.97, rel=1e-3)
    assert float(coherence_weight(np.array(1.0))) == pytest.approx(0.99875, abs=1e-4)


def test_phases_are_compared_around_the_circle():
    T = np.full(60, -1.0 + 1e-9j)
    points = target(responses(np.ones(60), T))
    r = residual(points, np.conj(T)[:, None, None])
    assert float(r @ r) < 1e-6


def test_only_the_longest_coherent_range_is_matched():
    coherence = np.concatenate([np.full(6, 0.9), np.full(4, 0.3), np.full(30, 0.8), np.full(20, 0.59)])
    np.testing.assert_array_equal(good_range(coherence), np.arange(10, 40))
    assert chosen_points(coherence)[[0, -1]].tolist() == [10, 39]
    assert good_range(np.array([0.9, 0.9, 0.9, 0.1])).size == 0
