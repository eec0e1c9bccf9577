"""The lag of a plant is counted on over turns."""

import numpy as np
import pytest

from controllers.pid_phase import lag_rad, most_lag_rad
from design.discretise import sample
from design.linear_plant import LinearPlant

Ts_s = 0.001


def _plant(poles: list[complex], zeros: list[complex]) -> LinearPlant:
    """prod (s - zero) / prod (s - pole), its sign that of a positive steady gain before integrators, in controller form."""
    a, b = np.poly(poles).real, np.poly(zeros).real if zeros else np.ones(1)
    n = len(poles)
    A = np.vstack([-a[1:], np.eye(n - 1, n)])
    C = np.concatenate([np.zeros(n - len(b)), b])[np.newaxis] * np.sign(b[-1])
    return LinearPlant(A, np.eye(n, 1), C)


@pytest.mark.parametrize(
    ("poles", "zeros", "lag_deg"),
    [
        ([0.0] * 5, [], 450.0),
        ([0.0, -2.0], [], 135.0),
        ([2.0], [], 135.0),
        ([-2.0, -2.0], [2.0], 135.0),
        ([0.0, -2.0], [-2.0], 90.0),
        ([-1.0 + 1.0j, -1.0 - 1.0j], [], 180.0 - np.degrees(np.arctan2(4.0, 2.0**2 - 2.0))),
    ],
)
def test_a_plant_lags_by_the_angles_of_its_poles_less_those_of_its_zeros(
    poles: list[complex], zeros: list[complex], lag_deg: float
) -> None:
    # Truth at 2 rad/s: 90 deg an integrator, 45 deg of a pole or zero at -2 rad/s, 135 deg of a pole at +2 rad/s. The hold delays by half
    # a sample, 0.06 deg.
    omega_rad_s = 2.0
    found = lag_rad(sample(_plant(poles, zeros), Ts_s), np.exp(1j * omega_rad_s * Ts_s)[np.newaxis])
    assert np.degrees(found[0]) == pytest.approx(lag_deg, abs=0.5)


def test_a_pid_leads_by_less_than_its_derivative_and_its_loop_keeps_a_distance() -> None:
    # Truth: 1 + 10 x leads 1 + x / 10 least by asin(10 / 12) = 56.4 deg; |1 / (1 + L)| = 1 at |L| = 1 is 60 deg from -180 deg.
    assert np.degrees(most_lag_rad(10.0, 1.0)) == pytest.approx(180.0 + 56.443 - 60.0, abs=1e-3)
