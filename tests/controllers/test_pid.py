"""The PID: its tuning holds the bound everywhere, judged by other means than it was tuned by, and its integral does not wind up."""

import math
from dataclasses import replace

import numpy as np
import pytest

from controllers.equations.designing import points_of
from design.settings import read_settings
from records.table import AXES, changed_axis
from tests.controllers.rows import ce150, designed
from tests.soak import sampled


@pytest.mark.parametrize("axis", sampled(AXES, keep=["elevation"]))
def test_the_sensitivity_of_python_control_is_the_bound_at_its_worst_operating_point(axis: str) -> None:
    points = points_of(ce150(), read_settings(ce150()))
    tuning = designed("pid")[1].origin[axis]
    worst = max(_sensitivity(plant, tuning, 0.01) for plant in points.sampled(axis))
    assert worst == pytest.approx({"elevation": 3.0, "azimuth": 2.0}[axis], rel=0.02)
    assert tuning["Ms_max"] == pytest.approx(worst, rel=0.02)


def _sensitivity(plant: object, tuning: dict[str, float], Ts_s: float) -> float:
    """Largest |S| from transfer functions in z, poles checked."""
    import control  # a second and a half of modules, which one worker alone is to load

    system = control.ss(np.eye(3) + plant.N, plant.B, plant.C, [[0.0]], Ts_s)  # type: ignore[attr-defined]
    z, g = control.tf([1.0, 0.0], [1.0], Ts_s), -math.expm1(-Ts_s / tuning["filter_s"])
    slope = tuning["k_d"] / tuning["filter_s"] * (1.0 - g * z / (z - 1.0 + g))
    pid = tuning["k_p"] + tuning["k_i"] * Ts_s / (z - 1.0) + slope
    frequencies = np.geomspace(0.05, 100.0, 2000)
    loop = system(np.exp(1j * frequencies * Ts_s)) * pid(np.exp(1j * frequencies * Ts_s))
    closed = control.feedback(control.ss(pid) * system)
    assert np.max(np.abs(closed.poles())) < 1.0
    return float(np.max(np.abs(1.0 / (1.0 + loop))))


def test_a_long_saturation_leaves_nothing_in_the_integral() -> None:
    # Truth: after 20 s against a held arm the voltage leaves its limit within 0.1 s of the error's change of sign.
    row, table = designed("pid")
    assert _late_s(row.float_law(table)) < 0.1
    gains = replace(table.axes[0].gains, tracking_gain=0.0)
    winding = changed_axis(table, "elevation", gains=gains)
    assert _late_s(row.float_law(winding)) > 0.5


def _late_s(law: object) -> float:
    law.reset(-0.7, 0.0)  # type: ignore[attr-defined]
    for _ in range(2000):
        law.step(0.6, 0.0, -0.7, 0.0)  # type: ignore[attr-defined]
    for late in range(1000):
        if law.step(-0.7, 0.0, 0.3, 0.0)[0] < 10.0 and late > 100:  # type: ignore[attr-defined]
            return 0.01 * (late - 100)
    return math.inf
