"""Truth: a slowly unstable system of two states, differences of a free run."""

import numpy as np
import pytest

from identification.envelope.flights.flight import Deviations
from identification.envelope.state_equation import initial_state
from identification.envelope.state_equation.closed_loop import optimise
from identification.envelope.state_equation.free_run import Model, free_run, model_of, one_step, slopes
from identification.envelope.state_equation.initial_state import (
    MARGINS_MOVED,
    as_measured,
    automatic,
    by_hand,
    over_grid,
)
from identification.envelope.state_equation.recursive import history, pairs

# A pair of eigenvalues of modulus 1.002 and a period of 2 pi / 0.06 samples, as a phugoid's.
TRUTH = Model(
    1.002 * np.array([[np.cos(0.06), 0.3], [-(np.sin(0.06) ** 2) / 0.3, np.cos(0.06)]]), np.array([[0.0], [0.2]]), 0.05
)
MARGINS = np.array([1.0, 0.3])


def flown(noise, flights=3, rows=240, seed=1, drift=0.0):
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.choice([-1.0, 0.0, 1.0], (flights, rows // 20, 1)), 20, axis=1)
    start = rng.standard_normal((flights, 2)) * MARGINS
    x = free_run(TRUTH, u, start, np.full((flights, 2), drift))
    x = x + noise * MARGINS * rng.standard_normal(x.shape)
    return Deviations(0.05, u, x, np.zeros((flights, rows, 3)), np.zeros((flights, 6)), ("",) * flights)


def test_slopes_are_those_of_differences():
    data = flown(0.0, flights=2, rows=60)
    by_model, by_own = slopes(TRUTH, data.u, data.x)
    start, drift = data.x[:, 0], np.zeros((2, 2))
    for place in range(6):
        row, column = divmod(place, 3)
        ways = []
        for sign in (1.0, -1.0):
            AB = np.hstack([TRUTH.A, TRUTH.B])
            AB[row, column] += sign * 1e-6
            ways.append(free_run(Model(AB[:, :2], AB[:, 2:], 0.05), data.u, start))
        assert (ways[0] - ways[1]) / 2e-6 == pytest.approx(by_model[:, :, :, place], rel=1e-5, abs=1e-5)
    moved = free_run(TRUTH, data.u, start + np.array([0.5, 0.0]), drift + np.array([0.0, 0.25])) - data.x
    assert moved == pytest.approx(np.broadcast_to(by_own @ [0.5, 0.0, 0.0, 0.25], moved.shape), rel=1e-9, abs=1e-9)


def test_a_free_run_of_the_truth_is_the_truth():
    data = flown(0.0)
    assert free_run(TRUTH, data.u, data.x[:, 0]) == pytest.approx(data.x, abs=1e-12)
    assert one_step(TRUTH, data) == pytest.approx(data.x, abs=1e-12)


def test_the_optimisation_finds_the_system_from_a_start_that_diverges():
    data = flown(0.0)
    wrong = Model(1.03 * TRUTH.A, 0.5 * TRUTH.B, 0.05)
    assert np.abs(free_run(wrong, data.u, data.x[:, 0])).max() > 10 * np.abs(data.x).max()
    found = optimise(wrong, data, MARGINS).model
    assert pytest.approx(TRUTH.A, abs=1e-5) == found.A
    assert pytest.approx(TRUTH.B, abs=1e-5) == found.B


def test_noise_biases_one_step_estimates_and_not_the_free_run():
    """Errors in the regressors pull least squares towards zero: the one-step model damps, the other keeps the eigenvalues."""
    data = flown(2.0)
    open_loop = model_of(history(pairs(data))[-1], 0.05)
    closed = optimise(open_loop, data, MARGINS).model
    assert open_loop.spectral_radius < TRUTH.spectral_radius - 3e-3
    assert abs(closed.spectral_radius - TRUTH.spectral_radius) < 1e-3


def test_a_drift_is_not_taken_for_dynamics():
    data = flown(0.02, drift=0.001)
    found = optimise(model_of(history(pairs(data))[-1], 0.05), data, MARGINS)
    assert pytest.approx(TRUTH.A, abs=1e-4) == found.model.A
    assert found.own.drift == pytest.approx(np.full((3, 2), 0.001), abs=2e-4)


def test_automatic_tuning_finds_a_shift_within_its_bounds():
    data, shift = flown(0.0, flights=1), np.array([0.2, -0.05])
    assert np.all(np.abs(shift) < MARGINS_MOVED * MARGINS)
    shifted = Deviations(0.05, data.u, data.x.copy(), data.y, data.trim, data.names)
    shifted.x[0, 0] += shift
    assert automatic(TRUTH, shifted, MARGINS).start == pytest.approx(data.x[0, 0], abs=2e-3)


def test_late_errors_do_not_break_the_first_three_seconds(monkeypatch):
    """A model that diverges late: the whole flight's best start leaves the margins early, the tuned one does not for 60 rows of 0.05 s."""
    data = flown(0.05, flights=1)
    model = Model(1.01 * TRUTH.A, TRUTH.B, 0.05)

    def broken(tuned):
        return np.any(np.abs(tuned.x - data.x[0])[:60] > MARGINS)

    assert not broken(automatic(model, data, MARGINS, trim=True))
    monkeypatch.setattr(initial_state, "REQUIRED_s", 0.0)
    assert broken(automatic(model, data, MARGINS, trim=True))


def test_beyond_a_bound_it_stays_there_and_no_step_inwards_helps():
    """Karush, Kuhn and Tucker: the cost's slope points outwards at the active bound and vanishes for the free state."""
    data = flown(0.0, flights=1)
    shifted = Deviations(0.05, data.u, data.x.copy(), data.y, data.trim, data.names)
    shifted.x[0, 0] += [1.0, 0.0]

    def cost(start):
        return np.sum(((free_run(TRUTH, data.u, start[None])[0] - shifted.x[0]) / MARGINS) ** 2)

    found = automatic(TRUTH, shifted, MARGINS).start
    assert found[0] == pytest.approx(shifted.x[0, 0, 0] - MARGINS_MOVED * MARGINS[0], abs=1e-9)
    outwards, along = np.array([-1e-4, 0.0]), np.array([0.0, 1e-4])
    assert cost(found + outwards) < cost(found)
    assert cost(found) <= min(cost(found + along), cost(found - along))


def test_a_grid_leaves_no_more_points_outside_than_the_measured_start():
    data = flown(0.1, flights=1, seed=4)

    def outside(tuned):
        return np.mean(np.abs(tuned.x - data.x[0]) > MARGINS)

    model = Model(TRUTH.A * 1.001, TRUTH.B, 0.05)
    assert outside(over_grid(model, data, MARGINS)) < outside(as_measured(model, data))


def test_by_hand_the_run_starts_where_it_was_typed_in_and_elsewhere_as_measured():
    """Truth: a first row that is off; the true start typed in as a whole signal, so trim and all, gives the true motion back."""
    true = flown(0.0, flights=1)
    x, trim = true.x.copy(), np.array([[0.0, 0.0, 0.0, 0.0, 20.0, -3.0]])
    x[0, 0] += [0.2, -0.05]
    data = Deviations(0.05, true.u, x, true.y, trim, true.names)
    u_m_s, v_m_s = true.x[0, 0] + [20.0, -3.0]
    assert by_hand(TRUTH, data, {"u_m_s": u_m_s, "v_m_s": v_m_s}).x == pytest.approx(true.x[0], abs=1e-12)
    one = by_hand(TRUTH, data, {"u_m_s": u_m_s})
    assert one.start == pytest.approx([true.x[0, 0, 0], x[0, 0, 1]], abs=1e-12)
    assert np.array_equal(by_hand(TRUTH, data, {}).x, as_measured(TRUTH, data).x)


def test_a_wrong_trim_is_found_as_a_drift():
    data = flown(0.0, flights=1, drift=0.001)
    plain, trimmed = (automatic(TRUTH, data, MARGINS, trim) for trim in (False, True))
    assert trimmed.drift == pytest.approx([0.001, 0.001], abs=1e-5)
    assert np.sum((trimmed.x - data.x[0]) ** 2) < 1e-3 * np.sum((plain.x - data.x[0]) ** 2)
