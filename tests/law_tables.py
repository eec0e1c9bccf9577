"""Controller tables for tests, placed here in 50 digits: they need no design stage and have one digest on every processor."""

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
from flint import arb, arb_mat, ctx

from codegen.law_equations import axis_state
from codegen.law_frame import state_size
from records.table import AxisLaw, ControllerTable, Polynomial, Schedule, changed_axis

SAMPLE_PERIOD_S = 0.01
RESOLUTION_RAD = 2.0 * np.pi / 4096.0
PSI_GRID_RAD = tuple(np.radians(np.arange(-40.0, 41.0, 5.0)).tolist())
DIGITS = 50
Row = list[arb]
AXIS_STATE_FIELDS = tuple(axis_state(3).__dataclass_fields__)
STATE_WORDS = state_size(axis_state(3), 2)


@cache
def ce150_table(degree: int = 3, prefilter_time_constant_s: float = 0.35) -> ControllerTable:
    """Like the CE150 of facts/ce150.md C4: an integrating elevation (dom2/int) and an azimuth without (eq4/q3)."""
    elevation, azimuth = _both_placed()
    with ctx.workdps(DIGITS):
        return ControllerTable(
            plant="ce150",
            sample_period_s=SAMPLE_PERIOD_S,
            schedule=Schedule("elevation", PSI_GRID_RAD[0], PSI_GRID_RAD[-1]),
            axes=(
                _axis(elevation, degree, (5.607, 0.0, -1.53), prefilter_time_constant_s, (0.0, 10.0, 0.0), 0.7),
                _axis(azimuth, degree, (1.97, 0.0, -0.33), prefilter_time_constant_s, (-10.0, 10.0, 0.0), 2.27),
            ),
            origin={"made_for": "tests"},
        )


@cache
def _both_placed() -> tuple[list[tuple[Row, Row]], list[tuple[Row, Row]]]:
    """Q and P of both axes over the grid."""
    with ctx.workdps(DIGITS):
        elevation_poles = [(arb(SAMPLE_PERIOD_S) * s).exp() for s in (-3.0, -4.0, -7.0, -12.0, -15.0, -20.0)]
        azimuth_poles = [(arb(SAMPLE_PERIOD_S) * -4.0).exp()] * 6
        elevation = [_placed(*_elevation_plant(psi), elevation_poles, integral=True) for psi in PSI_GRID_RAD]
        azimuth = [_placed(*_azimuth_plant(psi), azimuth_poles, integral=False) for psi in PSI_GRID_RAD]
    return elevation, azimuth


def _axis(
    placed: list[tuple[Row, Row]],
    degree: int,
    feedforward_V: Polynomial,
    prefilter_time_constant_s: float,
    voltages: tuple[float, float, float],
    reference_rad: float,
) -> AxisLaw:
    q = zip(*(_delta_form(Q) for Q, _ in placed), strict=True)
    p = zip(*(_recursion_delta_form(P) for _, P in placed), strict=True)
    a = _recursion_delta_form(_with_roots([arb("0.9")] * 3))
    return AxisLaw(
        q_V_rad=tuple(_fitted(column, degree) for column in q),
        p=tuple(_fitted(column, degree) for column in p),
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


def _fitted(values: tuple[arb, ...], degree: int) -> Polynomial:
    """Least squares in Psi; what vanishes on the grid vanishes exactly."""
    if max(map(abs, values)) < 1e-9:
        return (0.0,)
    powers = arb_mat([[arb(psi) ** power for power in range(degree + 1)] for psi in PSI_GRID_RAD])
    transposed = powers.transpose()
    return tuple(float(c) for c in (transposed * powers).solve(transposed * _column(values)).entries())


def _elevation_plant(psi_rad: float) -> tuple[arb, Row]:
    """Rotor lag of 7 /s into a damped pendulum of -tau_gE sin(psi)/J_E: numerator, and denominator behind s^3."""
    stiffness = 0.0383 / 4.37e-3 * -arb(psi_rad).sin()
    return arb(22), [7 + 0.42, 7 * 0.42 + stiffness, 7 * stiffness]


def _azimuth_plant(psi_rad: float) -> tuple[arb, Row]:
    """Tail rotor lag of 3.5 /s into a damped inertia J_A cos(psi)."""
    inertia = 4.14e-3 * arb(psi_rad).cos()
    damping = 8.69e-3 / inertia
    return 0.02 / inertia, [3.5 + damping, 3.5 * damping, arb(0)]


def _sampled(numerator: arb, denominator: Row) -> tuple[Row, Row]:
    """Zero-order hold of a third-order plant: B and A in powers of z^-1, by Faddeev and LeVerrier from the matrix exponential."""
    s = arb_mat(4, 4)
    s[0, 1] = s[1, 2] = arb(1)
    for column, value in enumerate(reversed(denominator)):
        s[2, column] = -value
    s[2, 3] = numerator
    held = (s * arb(SAMPLE_PERIOD_S)).exp().tolist()
    state, drive, one = arb_mat([row[:3] for row in held[:3]]), _column([row[3] for row in held[:3]]), _identity(3)
    B, A, power = [arb(0)], [arb(1)], one
    for order in (1, 2, 3):
        B.append((power * drive)[0, 0])
        step = state * power
        A.append(-step.trace() / order)
        power = step + one * A[-1]
    return B, A


def _placed(numerator: arb, denominator: Row, poles: Row, *, integral: bool) -> tuple[Row, Row]:
    """Q, P of third order in z^-1 with A P + B Q = product of (1 - pole z^-1); the free degree is P(1) = 0 or q_3 = 0."""
    B, A = _sampled(numerator, denominator)
    system = arb_mat(8, 8)
    for column in range(4):
        for row in range(4):
            system[column + row, column] = A[row]
            system[column + row, 4 + column] = B[row]
    for column in range(8):
        system[7, column] = float(column < 4 if integral else column == 7)
    solved = system.solve(_column([*_with_roots(poles), arb(0)])).entries()
    return solved[4:], solved[:4]


def _column(values: Sequence[arb]) -> arb_mat:
    return arb_mat([[value] for value in values])


def _identity(order: int) -> arb_mat:
    return arb_mat([[int(row == column) for column in range(order)] for row in range(order)])


def _with_roots(roots: Row) -> Row:
    """Coefficients of the product of (1 - root z^-1)."""
    product = [arb(1)]
    for root in roots:
        product = [one - root * before for one, before in zip([*product, 0], [0, *product], strict=True)]
    return product


def _delta_form(Q: Row) -> Row:
    """Coefficients in powers of delta = 1 - z^-1, from z^-i = (1 - delta)^i."""
    return [(-1) ** power * sum(math.comb(i, power) * Q[i] for i in range(power, len(Q))) for power in range(len(Q))]


def _recursion_delta_form(P: Row) -> Row:
    """p_0, p_1, p_2 of P = 1 - z^-1 [(1 - p_0) + p_1 delta + p_2 delta^2]."""
    bracket = _delta_form([-coefficient for coefficient in P[1:]])
    return [1 - bracket[0], bracket[1], bracket[2]]


@cache
def dense_table(seed: int = 3) -> ControllerTable:
    """A table in which every term is present and every coefficient moves the last digits of the result; it need not fly."""
    rng = np.random.default_rng(seed)
    table = ce150_table()
    for name in ("elevation", "azimuth"):
        axis = table.axis(name)
        table = changed_axis(
            table,
            name,
            q_V_rad=tuple(_dense(scale, rng) for scale in (2.0, 5.0, 20.0, 80.0)),
            p=tuple(_dense(scale, rng) for scale in (0.1, 0.9, 0.6)),
            a=(0.125, 0.5, 0.125),
            feedforward_V=_dense(0.3 * axis.u_max_V, rng)[:3],
        )
    return table


@cache
def tapered_table() -> ControllerTable:
    """The dense table with a polynomial of each axis that falls off: its powers are of three, two and one products in fixed point."""
    table = dense_table()
    for name in ("elevation", "azimuth"):
        q_0, q_1, q_2, (scale, *_) = table.axis(name).q_V_rad
        falling = tuple(scale * share for share in (1.0, 0.3, -0.08, 0.05))
        table = changed_axis(table, name, q_V_rad=(q_0, q_1, q_2, falling))
    return table


def _dense(scale: float, rng: np.random.Generator) -> Polynomial:
    return (
        scale,
        *(float(scale * sign * size) for sign, size in zip((1, -1, 1), rng.uniform(0.2, 0.6, 3), strict=True)),
    )
