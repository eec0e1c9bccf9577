"""Gains of the second rig's controllers, drawn until the loop is stable with room to spare all over the elevation's
range."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_are

from blind.rigs.second.simulation import FASTEST_RAD_S, PROGRAM
from blind.simulation.ce150 import Rig
from blind.simulation.native import opened
from blind.simulation.rest import rest, rotor_damping, rotor_thrust

Array = NDArray[np.float64]
CONTROLLERS = ("pid", "cascade", "feedback")
ELEVATION_RAD = 0.6
DRAWS = 200
SLOWEST_RAD_S = 0.25
LATE_S = 0.06
ROTOR_AND_BODY = (("M", "E"), ("T", "A"))
# Angle, integral and rate gains at bandwidth 1, by axis, V/rad, V/(rad s), V s/rad.
PID = ((3.8, 2.3, 2.0), (3.0, 0.8, 1.5))
# Angle to rate in 1/s, then rate and its integral to volts.
CASCADE = ((1.3, 1.9, 1.7), (1.1, 2.2, 1.0))
# Weights of the integral, angle and rate against one volt.
WEIGHTS = ((16.0, 30.0, 5.0), (0.8, 8.0, 1.0))


def draw_controller(rig: Rig, period_s: float, rng: Generator) -> tuple[str, Any]:
    """(kind, the C structure control_t) for the rig as stated; raises RuntimeError where no draw is stable."""
    kind = CONTROLLERS[rng.integers(len(CONTROLLERS))]
    for _ in range(DRAWS):
        filter_s = float(rng.uniform(0.02, 0.05))
        gains = np.array([_gains(kind, rig, axis, rng) for axis in range(2)])
        if all(stable(rig, kind, axis, gains[axis], period_s, filter_s) for axis in range(2)):
            return kind, _structure(rig, kind, gains, period_s, filter_s, float(rng.uniform(1.5, 3.0)))
    raise RuntimeError(f"no stable {kind} controller in {DRAWS} draws")


def _gains(kind: str, rig: Rig, axis: int, rng: Generator) -> Array:
    b = float(rng.uniform(0.8, 1.2))
    odd = np.exp(rng.uniform(-0.15, 0.15, 3))
    if kind == "pid":
        return np.array([*(np.array(PID[axis]) * odd * (b**2, b**3, b)), 0.0])
    if kind == "cascade":
        return np.array([*(np.array(CASCADE[axis]) * odd * (b, b, b**2)), 0.0])
    weights = np.array(WEIGHTS[axis]) * np.exp(rng.uniform(-0.5, 0.5, 3))
    A, B = linear(rig, axis, 0.2)
    A = np.block([[np.zeros((1, 1)), -np.eye(1, 3)], [np.zeros((3, 1)), A]])
    B = np.vstack([[0.0], B])
    P = solve_continuous_are(A, B, np.diag([*weights, 0.0]), np.eye(1))
    K = (B.T @ P)[0]
    return np.array([K[1], -K[0], K[2], K[3]])


def linear(rig: Rig, axis: int, psi_rad: float) -> tuple[Array, Array]:
    """(A, B) of angle, rate, rotor speed of one axis about rest at an elevation; input in volts."""
    rotor, body = ROTOR_AND_BODY[axis]
    w = rest(rig, psi_rad, FASTEST_RAD_S)[1][axis]
    inertia = rig.value(f"J_{body}")
    lag = rotor_damping(rig, rotor).deriv()(w)
    lift = rig.value(f"l_{rotor}") * rotor_thrust(rig, rotor).deriv()(w)
    spring = rig.value("tau_gE") * np.sin(psi_rad) if axis == 0 else 0.0
    shape = 1.0 if axis == 0 else np.cos(psi_rad)
    damping = rig.value(f"b_v{body}") / shape
    A = np.array([[0.0, 1.0, 0.0], [spring / inertia, -damping / inertia, lift / inertia], [0.0, 0.0, -lag]])
    return A, np.array([[0.0], [0.0], [rig.value(f"K_{rotor}")]])


def stable(rig: Rig, kind: str, axis: int, gains: Sequence[float] | Array, period_s: float, filter_s: float) -> bool:
    """Whether the sampled loop decays, and still does not grow when its commands come 60 ms late, wherever the arm
    stands."""
    late = int(np.ceil(LATE_S / period_s))
    for psi in np.linspace(-ELEVATION_RAD, ELEVATION_RAD, 7):
        plant = linear(rig, axis, float(psi))
        if _spectral_radius(plant, kind, gains, period_s, filter_s, 0) > np.exp(-SLOWEST_RAD_S * period_s):
            return False
        if _spectral_radius(plant, kind, gains, period_s, filter_s, late) > 1.0:
            return False
    return True


def _spectral_radius(
    plant: tuple[Array, Array], kind: str, g: Sequence[float] | Array, period_s: float, filter_s: float, late: int
) -> float:
    """Of one period of the loop: angle, rate, speed, then the controller's last angle, rate, sum, speed, then commands
    under way."""
    A, B = plant
    whole = expm(np.block([[A, B], [np.zeros((1, 4))]]) * period_s)
    angle, rate, speed, last, tracked, total, modelled, *queue = np.eye(7 + late)
    new_rate = tracked + period_s / (filter_s + period_s) * ((angle - last) / period_s - tracked)
    more = -g[0] * angle - new_rate if kind == "cascade" else -angle
    u = g[1] * more + g[2] * total if kind == "cascade" else -g[0] * angle + g[1] * total - g[2] * new_rate
    if kind == "feedback":
        u = u - g[3] * modelled
    queue = [*queue, u]
    body = whole[:3] @ np.array([angle, rate, speed, queue[0]])
    after = modelled + period_s * (B[2, 0] * u + A[2, 2] * modelled)
    step = np.array([*body, angle, new_rate, total + period_s * more, after, *queue[1:]])
    return float(np.abs(np.linalg.eigvals(step)).max())


def _structure(rig: Rig, kind: str, gains: Array, period_s: float, filter_s: float, rate_limit_rad_s: float) -> Any:
    ffi, _ = opened(PROGRAM)
    grid = np.linspace(-ELEVATION_RAD, ELEVATION_RAD, 13)
    at_rest = (rest(rig, float(psi), FASTEST_RAD_S) for psi in grid)
    volts, speeds = (np.array(table) for table in zip(*at_rest, strict=True))
    return ffi.new(
        "control_t *",
        {
            "kind": CONTROLLERS.index(kind),
            "gain": gains.tolist(),
            "feed_V": [np.polynomial.polynomial.polyfit(grid, volts[:, i], 2).tolist() for i in range(2)],
            "feed_rad_s": [np.polynomial.polynomial.polyfit(grid, speeds[:, i], 2).tolist() for i in range(2)],
            "rate_filter_s": filter_s,
            "rate_limit_rad_s": rate_limit_rad_s,
            "period_s": period_s,
        },
    )
