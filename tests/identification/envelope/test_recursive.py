"""Truth: the normal equations in closed form, a system with prime coefficients, exponents by hand."""

import numpy as np
import pytest

from identification.envelope.flights.flight import Deviations
from identification.envelope.state_equation.recursive import Pairs, best, history, pairs, potential
from records.errors import BadInput

A = np.array([[0.7, 0.2], [-0.3, 0.5]])
B = np.array([[0.11], [0.13]])


def flights(starts, rows=40, seed=0):
    """Noise-free flights of x(k + 1) = A x + B u from several starts."""
    rng = np.random.default_rng(seed)
    u = rng.standard_normal((len(starts), rows, 1))
    x = np.zeros((len(starts), rows, 2))
    x[:, 0] = starts
    for k in range(rows - 1):
        x[:, k + 1] = x[:, k] @ A.T + u[:, k] @ B.T
    return Deviations(0.05, u, x, np.zeros((len(starts), rows, 3)), np.zeros((len(starts), 6)), ("",) * len(starts))


@pytest.mark.parametrize("forgetting", [1.0, 0.97])
def test_the_recursion_solves_the_weighted_normal_equations(forgetting):
    """From P = large I and theta = 0 it solves (IO' W IO + gamma^s / large I) theta = IO' W X exactly, (2.17) with a trace of ridge."""
    rng = np.random.default_rng(3)
    rows = Pairs(rng.standard_normal((60, 3)), rng.standard_normal((60, 2)))
    weight = forgetting ** np.arange(59, -1, -1.0)
    ridge = forgetting**60 / 1e6 * np.eye(3)
    truth = np.linalg.solve((rows.io.T * weight) @ rows.io + ridge, (rows.io.T * weight) @ rows.after)
    assert history(rows, forgetting)[-1] == pytest.approx(truth, rel=1e-8)


def test_a_known_system_comes_back_and_joints_do_not_disturb():
    data = flights(np.array([[3.0, -5.0], [-7.0, 2.0], [0.0, 11.0]]))
    truth = np.hstack([A, B]).T
    assert history(pairs(data))[-1] == pytest.approx(truth, abs=1e-6)
    across = np.concatenate([data.x.reshape(-1, 2), data.u.reshape(-1, 1)], axis=1)
    naive = history(Pairs(across[:-1], across[1:, :2]))[-1]
    assert np.abs(naive - truth).max() > 0.05


def test_forgetting_follows_a_change():
    rng = np.random.default_rng(5)
    io = rng.standard_normal((400, 1))
    after = io * np.where(np.arange(400) < 200, 1.0, 2.0)[:, None]
    rows = Pairs(np.hstack([io, rng.standard_normal((400, 1))]), after)
    assert history(rows, 0.9)[-1][0, 0] == pytest.approx(2.0, abs=1e-6)
    assert history(rows, 1.0)[-1][0, 0] == pytest.approx(1.5, abs=0.1)


def test_potential_by_hand_and_the_best_of_three():
    # Errors of the three estimates in units of the radius: (0, 0), (1, 0), (1, 1/2).
    rows = Pairs(np.array([[1.0], [1.0]]), np.array([[0.0, 0.0], [0.0, 0.0]]))
    thetas = np.array([[[0.0, 0.0]], [[2.0, 0.0]], [[2.0, 0.5]]])
    radius = np.array([2.0, 1.0])
    truth = [4.0, 2 * np.exp(-4.0) + 2.0, 2 * np.exp(-4.0) + 2 * np.exp(-1.0)]
    assert potential(thetas, rows, radius) == pytest.approx(truth, rel=1e-14)
    assert best(thetas, rows, radius)[0] == 0


def test_a_factor_above_one_is_refused():
    with pytest.raises(BadInput, match="forgetting factor"):
        history(Pairs(np.ones((2, 2)), np.ones((2, 1))), 1.1)
