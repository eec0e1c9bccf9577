"""Controller tables for tests, placed here with NumPy and SciPy so that they need no design stage."""

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete

from records.table import AxisLaw, ControllerTable, Polynomial

SAMPLE_PERIOD_S = 0.01
RESOLUTION_RAD = 2.0 * np.pi / 4096.0
PSI_GRID_RAD = np.radians(np.arange(-40.0, 41.0, 5.0))


@cache
def ce150_table(degree: int = 3, prefilter_time_constant_s: float = 0.35) -> ControllerTable:
    """Like the CE150 of facts/ce150.md C4: an integrating elevation (dom2/int) and an azimuth without (eq4/q3)."""
    elevation_poles = np.exp(SAMPLE_PERIOD_S * np.array([-3.0, -4.0, -7.0, -12.0, -15.0, -20.0]))
    azimuth_poles = np.exp(SAMPLE_PERIOD_S * np.full(6, -4.0))
    elevation = [_placed(_elevation_plant(psi), elevation_poles, integral=True) for psi in PSI_GRID_RAD]
    azimuth = [_placed(_azimuth_plant(psi), azimuth_poles, integral=False) for psi in PSI_GRID_RAD]
    return ControllerTable(
        plant="ce150",
        sample_period_s=SAMPLE_PERIOD_S,
        psi_min_rad=float(PSI_GRID_RAD[0]),
        psi_max_rad=float(PSI_GRID_RAD[-1]),
        elevation=_axis(elevation, degree, (5.607, 0.0, -1.53), prefilter_time_constant_s, (0.0, 10.0, 0.0), 0.7),
        azimuth=_axis(azimuth, degree, (1.97, 0.0, -0.33), prefilter_time_constant_s, (-10.0, 10.0, 0.0), 2.27),
        origin={"made_for": "tests"},
    )


def _axis(
    placed: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
    degree: int,
    feedforward_V: Polynomial,
    prefilter_time_constant_s: float,
    voltages: tuple[float, float, float],
    reference_rad: float,
) -> AxisLaw:
    q = np.array([_delta_form(Q) for Q, _ in placed])
    p = np.array([_recursion_delta_form(P) for _, P in placed])
    a = _recursion_delta_form(np.poly([0.9, 0.9, 0.9]))
    return AxisLaw(
        q_V_rad=tuple(_fitted(column, degree) for column in q.T),
        p=tuple(_fitted(column, degree) for column in p.T),
        a=(float(a[0]), float(a[1]), float(a[2])),
        feedforward_V=feedforward_V,
        prefilter_time_constant_s=prefilter_time_constant_s,
        u_min_V=voltages[0],
        u_max_V=voltages[1],
        u_safe_V=voltages[2],
        reference_min_rad=-reference_rad,
        reference_max_rad=reference_rad,
        resolution_rad=RESOLUTION_RAD,
    )


def _fitted(values: NDArray[np.float64], degree: int) -> Polynomial:
    """Least squares in Psi; what vanishes on the grid vanishes exactly."""
    if np.abs(values).max() < 1e-9:
        return (0.0,)
    return tuple(float(c) for c in np.polynomial.polynomial.polyfit(PSI_GRID_RAD, values, degree))


def _elevation_plant(psi_rad: float) -> NDArray[np.float64]:
    """Rotor lag of 7 /s into a damped pendulum of -tau_gE sin(psi)/J_E; columns: numerator, denominator in s."""
    stiffness = 0.0383 / 4.37e-3 * -np.sin(psi_rad)
    denominator = np.polymul([1.0, 7.0], [1.0, 0.42, stiffness])
    return np.array([np.array([0.0, 0.0, 0.0, 22.0]), denominator])


def _azimuth_plant(psi_rad: float) -> NDArray[np.float64]:
    """Tail rotor lag of 3.5 /s into a damped inertia J_A cos(psi)."""
    inertia = 4.14e-3 * np.cos(psi_rad)
    return np.array([np.array([0.0, 0.0, 0.0, 0.02 / inertia]), np.polymul([1.0, 3.5, 0.0], [1.0, 8.69e-3 / inertia])])


def _sampled(plant: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Zero-order hold of a third-order plant: B and A in powers of z^-1."""
    numerator, denominator, _ = cont2discrete((plant[0][-1:], plant[1]), SAMPLE_PERIOD_S)
    B = np.asarray(numerator).ravel()
    return np.concatenate([np.zeros(4 - len(B)), B]), np.asarray(denominator)


def _placed(
    plant: NDArray[np.float64], poles: NDArray[np.float64], *, integral: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Q, P of third order in z^-1 with A P + B Q = product of (1 - pole z^-1); the free degree is P(1) = 0 or q_3 = 0."""
    B, A = _sampled(plant)
    system = np.zeros((8, 8))
    for column in range(4):
        system[column : column + 4, column] = A
        system[column : column + 4, 4 + column] = B[:4] / np.abs(B).max()
    wanted = np.concatenate([np.poly(poles), [0.0]])
    free = np.array([1.0] * 4 + [0.0] * 4) if integral else np.array([0.0] * 7 + [1.0])
    system[7] = free
    wanted[7] = 0.0
    solved = np.linalg.solve(system, wanted)
    return solved[4:] / np.abs(B).max(), solved[:4]


def _delta_form(Q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coefficients in powers of delta = 1 - z^-1, from z^-i = (1 - delta)^i."""
    total = np.zeros(1)
    for index, coefficient in enumerate(Q):
        power = np.ones(1)
        for _ in range(index):
            power = np.polynomial.polynomial.polymul(power, [1.0, -1.0])
        total = np.polynomial.polynomial.polyadd(total, coefficient * power)
    return np.pad(total, (0, len(Q) - len(total)))


def _recursion_delta_form(P: NDArray[np.float64]) -> NDArray[np.float64]:
    """p_0, p_1, p_2 of P = 1 - z^-1 [(1 - p_0) + p_1 delta + p_2 delta^2]."""
    bracket = _delta_form(-np.asarray(P)[1:])
    return np.array([1.0 - bracket[0], bracket[1], bracket[2]])


@cache
def dense_table(seed: int = 3) -> ControllerTable:
    """A table in which every term is present and every coefficient moves the last digits of the result; it need not fly."""
    rng = np.random.default_rng(seed)
    table = ce150_table()
    for name in ("elevation", "azimuth"):
        axis = table.elevation if name == "elevation" else table.azimuth
        table = changed_axis(
            table,
            name,
            q_V_rad=tuple(_dense(scale, rng) for scale in (2.0, 5.0, 20.0, 80.0)),
            p=tuple(_dense(scale, rng) for scale in (0.1, 0.9, 0.6)),
            a=(0.125, 0.5, 0.125),
            feedforward_V=_dense(0.3 * axis.u_max_V, rng)[:3],
        )
    return table


def changed_axis(table: ControllerTable, name: str, **change: object) -> ControllerTable:
    """`table` with fields of one axis replaced."""
    axis = table.elevation if name == "elevation" else table.azimuth
    changed: ControllerTable = replace(table, **{name: replace(axis, **change)})  # type: ignore[arg-type]
    return changed


def _dense(scale: float, rng: np.random.Generator) -> Polynomial:
    return (
        scale,
        *(float(scale * sign * size) for sign, size in zip((1, -1, 1), rng.uniform(0.2, 0.6, 3), strict=True)),
    )
