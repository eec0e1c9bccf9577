"""Conditioned responses and coherence where the truth is known in closed form: two inputs, white noise, a loop closed around noise."""

import numpy as np
import pytest

from identification.frequency.responses.conditioned import frequency_responses
from identification.frequency.responses.record import Record
from identification.frequency.responses.spectra import transforms, window
from records.errors import BadInput

PERIOD_S = 0.05
OMEGA = np.geomspace(1.0, 10.0, 12)
LENGTHS_S = (20.0, 10.0)


def filtered(u, b, a):
    """y_k = a y_(k-1) + b u_(k-1): T = b / (z - a)."""
    y = np.zeros(u.size)
    for k in range(1, u.size):
        y[k] = a * y[k - 1] + b * u[k - 1]
    return y


def truth(b, a):
    return b / (np.exp(1j * OMEGA * PERIOD_S) - a)


def test_inputs_that_move_together_are_told_apart():
    """Two inputs whose coherence is 0.5: the response to one alone is wrong by the other's part, the conditioned one is not."""
    rng = np.random.default_rng(1)
    u = rng.standard_normal((8000, 2))
    u[:, 1] += u[:, 0]
    y = np.column_stack([filtered(u[:, 0], 1.0, 0.8) + filtered(u[:, 1], -0.6, 0.5)])
    found = frequency_responses([Record("white", PERIOD_S, u, y, u)], OMEGA, LENGTHS_S)
    one, other = truth(1.0, 0.8), truth(-0.6, 0.5)
    np.testing.assert_allclose(found.T[:, 0, 0], one, rtol=0.04)
    np.testing.assert_allclose(found.T[:, 0, 1], other, rtol=0.1)
    alone = frequency_responses([Record("one", PERIOD_S, u[:, :1], y, u[:, :1])], OMEGA, LENGTHS_S)
    assert np.median(np.abs(alone.T[:, 0, 0] / one - 1.0)) > 0.15


def test_coherence_is_the_share_of_power_that_the_input_explains():
    """y = u + n with variances 1 and 1: gamma^2 = 0.5, estimated over about 40 windows within 0.1."""
    rng = np.random.default_rng(2)
    u, noise = rng.standard_normal((2, 16000, 1))
    found = frequency_responses([Record("half", PERIOD_S, u, u + noise, u)], OMEGA, (20.0,))
    assert abs(float(np.mean(found.coherence)) - 0.5) < 0.06


def test_an_input_that_only_moves_with_another_has_no_coherence_of_its_own():
    """u_2 = u_1 + w and y = u_1 + n, all of variance 1: u_2 and y share a quarter of their power, all of it by u_1."""
    rng = np.random.default_rng(8)
    one, other, noise = rng.standard_normal((3, 16000, 1))
    u = np.hstack([one, one + other])
    found = frequency_responses([Record("led", PERIOD_S, u, one + noise, u)], OMEGA, (20.0,))
    alone = frequency_responses([Record("alone", PERIOD_S, u[:, 1:], one + noise, u[:, 1:])], OMEGA, (20.0,))
    assert abs(float(np.mean(alone.coherence)) - 0.25) < 0.08
    assert float(np.mean(found.coherence[:, 0, 1])) < 0.06
    assert abs(float(np.mean(found.coherence[:, 0, 0])) - 1.0 / 3.0) < 0.08  # of u_1 given u_2: 1/2 over 1/2 + 1


def test_the_random_error_is_what_responses_scatter_by():
    """60 records of y = u + n: the rms error of T and the one that eq (3) gives agree within a quarter."""
    rng = np.random.default_rng(3)
    off, told = [], []
    for _ in range(60):
        u, noise = rng.standard_normal((2, 4000, 1))
        found = frequency_responses([Record("noisy", PERIOD_S, u, u + noise, u)], OMEGA, (10.0,))
        off.append(np.abs(found.T[:, 0, 0] - 1.0))
        told.append(found.error[:, 0, 0])
    scatter = np.sqrt(np.mean(np.square(off)) / 2.0)  # of magnitude or phase alone
    assert float(np.sqrt(np.mean(np.square(told)))) == pytest.approx(float(scatter), rel=0.25)


def test_a_long_window_serves_low_frequencies_and_short_ones_high_ones():
    rng = np.random.default_rng(4)
    u, noise = rng.standard_normal((2, 8000, 1))
    found = frequency_responses([Record("noisy", PERIOD_S, u, u + noise, u)], OMEGA, (20.0, 5.0))
    assert np.all(found.weights[1, 0.79 * np.pi > OMEGA] == 0.0)
    assert np.all(found.weights[1, 0.8 * np.pi < OMEGA] > 0.5)
    np.testing.assert_allclose(found.weights.sum(axis=0), 1.0)


def test_in_a_closed_loop_the_reference_tells_the_plant_and_the_input_tells_the_controller():
    """y = T u + n, u = r - y / 2, much noise: through u the response is drawn to -2, through r it is right."""
    rng = np.random.default_rng(5)
    r, noise = rng.standard_normal(40000), rng.standard_normal(40000)
    u, y, x = np.zeros(r.size), np.zeros(r.size), 0.0
    for k in range(r.size):
        y[k] = x + noise[k]
        u[k] = r[k] - 0.5 * y[k]
        x = 0.5 * x + 0.5 * u[k]
    columns = [entry[:, None] for entry in (u, y, r)]
    record = Record("loop", PERIOD_S, *columns, "closed")
    right = frequency_responses([record], OMEGA, LENGTHS_S).T[:, 0, 0]
    drawn = frequency_responses([Record("loop", PERIOD_S, columns[0], columns[1], columns[0])], OMEGA, LENGTHS_S).T[
        :, 0, 0
    ]
    one = truth(0.5, 0.5)
    assert np.max(np.abs(right / one - 1.0)) < 0.2
    assert np.median(np.abs(drawn / one - 1.0)) > 0.3


def test_transforms_at_any_frequency_are_those_of_a_sum_written_out():
    rng = np.random.default_rng(6)
    signal = rng.standard_normal((50, 2))
    of = window(2.0, PERIOD_S, np.array([1.234]))
    first = signal[:40] - signal[:40].mean(axis=0)
    t = PERIOD_S * np.arange(40)
    hann = np.sin(np.pi * np.arange(40) / 40) ** 2
    hann /= np.sqrt(np.sum(hann**2))
    np.testing.assert_allclose(transforms(of, signal)[0, 0], (hann * np.exp(-1.234j * t)) @ first, rtol=1e-12)


@pytest.mark.parametrize(("second", "said"), [(0.0, "input 2 never moves"), (1.0, "inputs that always move together")])
def test_inputs_that_cannot_be_told_apart_are_refused(second, said):
    u = np.random.default_rng(7).standard_normal((1000, 1)) @ np.array([[1.0, second]])
    with pytest.raises(BadInput, match=said):
        frequency_responses([Record("one sweep", PERIOD_S, u, u[:, :1], u)], OMEGA, LENGTHS_S)
