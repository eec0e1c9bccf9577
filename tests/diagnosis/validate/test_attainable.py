"""What no model could better: in limits that are known, and by a filter that goes row by row."""

import numpy as np
import pytest

from diagnosis.validate.attainable import NO_PUSH, of_an_axis

TAU = np.array([0.01, 0.1, 0.5, 1.0])
R = 1e-7  # rad^2 s


def of_white_noise(q: float) -> np.ndarray:
    """The variance beside white noise alone, in closed form (Bar-Shalom, Li and Kirubarajan 2001, section 8.2)."""
    P_x, P_xv, P_v = np.sqrt(2.0) * q**0.25 * R**0.75, np.sqrt(q * R), np.sqrt(2.0) * q**0.75 * R**0.25
    return np.asarray(P_x + 2.0 * P_xv * TAU + P_v * TAU**2 + q * TAU**3 / 3.0)


def test_of_white_noise_it_is_the_closed_form() -> None:
    np.testing.assert_allclose(of_an_axis(0.3, NO_PUSH, R, TAU), of_white_noise(0.3), rtol=1e-6)


def test_a_push_that_is_forgotten_at_once_is_white_noise() -> None:
    np.testing.assert_allclose(of_an_axis(1e-12, (50.0, 1e-4), R, TAU), of_white_noise(2.0 * 50.0**2 * 1e-4), rtol=1e-4)


def test_a_push_that_stays_is_known_from_readings() -> None:
    # Unknown, 3 rad/s^2 move an axis by 1.5 rad within a second.
    assert of_an_axis(1e-9, (3.0, 1e4), 1e-12, TAU)[-1] < 0.05**2


def test_in_between_it_is_what_a_filter_of_single_rows_ends_at() -> None:
    # Truth: the Riccati recursion of the same axis, pushed with a correlation time of 0.2 s, read every 0.1 ms, then left alone for 0.1 s.
    q, (s, T), h = 0.01, (3.0, 0.2), 1e-4
    F = np.array([[1.0, h, h**2 / 2.0], [0.0, 1.0, h], [0.0, 0.0, np.exp(-h / T)]])
    Q = np.diag([0.0, q * h, s**2 * (1.0 - np.exp(-2.0 * h / T))])
    P = np.diag([1e-6, 1.0, s**2])
    for _ in range(20_000):
        P = F @ P @ F.T + Q
        P = P - np.outer(P[:, 0], P[0]) / (P[0, 0] + R / h)
    for _ in range(1_000):
        P = F @ P @ F.T + Q
    assert of_an_axis(q, (s, T), R, TAU)[1] == pytest.approx(P[0, 0], rel=0.02)
