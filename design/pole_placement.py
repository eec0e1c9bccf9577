"""Pole placement by eq (26), with the degree of freedom that the paper leaves open as a named choice.

    A(z) P(z) + B(z) Q(z) = (z - z_1) ... (z - z_6)                         (26), times z^-6:

    A = 1 + a_1 z^-1 + a_2 z^-2 + a_3 z^-3,    B = b_1 z^-1 + b_2 z^-2 + b_3 z^-3
    P = 1 + p_1 z^-1 + p_2 z^-2 + p_3 z^-3,    Q = q_0 + q_1 z^-1 + q_2 z^-2 + q_3 z^-3

as it stands for a plant of n = 3 states. The paper counts seven equations for the seven unknowns; that of z^0 reads 1 = 1, so six remain.

A roll-off adds p_4 z^-4 to P and one pole to place: Q/P then falls by 20 dB a decade towards the Nyquist frequency, where the controller
of eq (22) passes every encoder step on at its highest gain.

Solved in powers of z^-1 as in the paper, Q(1) = d_0 is the sum of numbers 3e4 times larger and keeps eight digits; those beyond depend
on the processor. What is left of eq (26) then is small, and in powers of gamma = z - 1, where nothing cancels, it is known to rounding:

    A dP + B dQ = (gamma - gamma_1) ... (gamma - gamma_n) - (A P + B Q),    row . (d unknowns) = value - row . unknowns

Such steps leave 1e-12 of each coefficient at most on the CE150. B of a plant of four states is a millionth of A, so that the last bit of
A P is the ninth digit of Q: the plant's polynomials come in extended precision, and what is left is worked out in it. A plant that is
slow beside its samples, or one of many states, whose roots lie so near z = 1 that eq (26) in z^-1 cannot tell them apart, begins in gamma
as well.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.direct_form import DeltaForm, DirectForm, controller_poles_z, to_direct
from design.loop import PlantPolynomials, closed_loop_polynomial, open_loop
from records.errors import BadInput

Array = NDArray[np.float64]

# Above this condition number the coefficients keep fewer than 6 digits more than the cancellation in Q(1) takes away.
MAX_CONDITION = 1e6
MAX_CONDITION_GAMMA = 1e8  # in powers of gamma nothing cancels: eight digits are left, as many as a table keeps
STEPS = 2  # each keeps the digits that the condition number leaves: the first ends beyond what a table keeps, the second beyond doubles


@dataclass(frozen=True)
class FreeDegree:
    """A condition `p` . (p_1 p_2 ..) + `q` . (q_0 .. q_n) = `value` that fixes the last unknown, and what it means.

    `p` and `q` make a row from the number of its unknowns.
    """

    p: Callable[[int], Sequence[float]]
    q: Callable[[int], Sequence[float]]
    value: float
    meaning: str

    def row(self, p_count: int, q_count: int) -> Array:
        """The condition's left side over the unknowns p_1 .., q_0 .. q_n."""
        return np.array([*self.p(p_count), *self.q(q_count)])


def _ones(count: int) -> list[float]:
    return [1.0] * count


def _zeros(count: int) -> list[float]:
    return [0.0] * count


INTEGRAL = "integral"
FREE_DEGREES: Mapping[str, FreeDegree] = {
    INTEGRAL: FreeDegree(_ones, _zeros, -1.0, "P(1) = 0: the controller integrates"),
    "q3_zero": FreeDegree(
        _zeros, lambda n: [*_zeros(n - 1), 1.0], 0.0, "q_3 = 0, the last q: lowest gain without an integrator"
    ),
    "q0_zero": FreeDegree(
        _zeros, lambda n: [1.0, *_zeros(n - 1)], 0.0, "q_0 = 0: the controller answers one sample later"
    ),
    "q_nyquist_zero": FreeDegree(
        _zeros, lambda n: [(-1.0) ** i for i in range(n)], 0.0, "Q(-1) = 0: no answer at the Nyquist frequency"
    ),
}


@dataclass(frozen=True)
class Placement:
    """A controller that places the poles, with the condition number of the scaled system that gave it, and the largest usable one."""

    controller: DirectForm
    condition: float
    limit: float = MAX_CONDITION

    @property
    def is_sound(self) -> bool:
        """Whether the coefficients have digits enough."""
        return self.condition < self.limit


def poles_z(poles_rad_s: Sequence[complex], sample_period_s: float) -> NDArray[np.complex128]:
    """z = exp(s Ts) of each pole."""
    return np.asarray(np.exp(np.asarray(poles_rad_s, dtype=complex) * sample_period_s))


def characteristic(poles: NDArray[np.complex128]) -> Array:
    """Eq (25) times z^-n: the coefficients (n + 1,) of z^0 .. z^-n of the product of (1 - z_i z^-1) over poles (n,)."""
    return np.asarray(np.poly(poles).real)


def sylvester(b: Array, a: Array, order: int) -> Array:
    """Coefficients of z^-1 .. z^-(n + order) of A (p_1 .. p_order) + B (q_0 .. q_n), shape (n + order, order + n + 1), from b and a
    (n + 1,) with b_0 = 0."""
    columns = [np.convolve(a, np.eye(order + 1)[index]) for index in range(1, order + 1)]
    columns += [np.convolve(b, np.eye(order + 1)[index]) for index in range(len(a))]
    return np.stack(columns, axis=1)[1:]


def placed_in_z(b: Array, a: Array, wanted: Array, free: FreeDegree) -> Placement:
    """Eq (26) solved for `wanted` (2 n + 1,), or one more with a roll-off, unjudged; b and a (n + 1,), b_0 = 0, a_0 = 1, ascending powers
    of z^-1. B is divided by max|b|, which takes the condition number of the CE150 from 1e6 to about 50."""
    states = len(a) - 1
    scale, order = float(np.max(np.abs(b))), len(wanted) - 1 - states
    unscale = np.array([1.0] * order + [1.0 / scale] * (states + 1))
    row = free.row(order, states + 1) * unscale
    size = float(np.max(np.abs(row)))
    system = np.vstack([sylvester(b / scale, a, order), row / size])
    target = np.append(wanted[1:] - np.append(a[1:], np.zeros(order)), free.value / size)
    condition = float(np.linalg.cond(system))
    if not condition < 1.0 / np.finfo(float).eps:  # A and B share a root, to rounding
        return Placement(DirectForm(np.zeros(states + 1), np.append(1.0, np.zeros(order))), math.inf)
    solution = np.linalg.solve(system, target) * unscale
    return Placement(DirectForm(q=solution[order:], p=np.append(1.0, solution[:order])), condition)


def placed_in_gamma(plant: PlantPolynomials, poles_rad_s: Sequence[complex], free: FreeDegree) -> Placement:
    """Eq (26) solved in powers of gamma from the start, unjudged."""
    states, order = len(plant.a) - 1, len(poles_rad_s) - len(plant.a) + 1
    nothing = DeltaForm(np.zeros(states + 1), np.zeros(order))
    system, missing, sizes = _in_gamma(plant, nothing, poles_rad_s, free)
    condition = float(np.linalg.cond(system))
    step = np.linalg.solve(system, missing) / sizes if condition < MAX_CONDITION_GAMMA else np.zeros(len(sizes))
    return Placement(to_direct(_form(plant, step)), condition, MAX_CONDITION_GAMMA)


def demand_usable(placement: Placement, where: str) -> None:
    """Raise BadInput naming `where` (axis and operating angle) when the system is ill-conditioned or when the controller has a pole outside
    the unit circle: both would place the poles on paper only."""
    if not placement.is_sound:
        raise BadInput(
            "pole placement, eq (26)",
            where,
            f"condition number {placement.condition:.1e}",
            f"below {placement.limit:g}",
            "A and B share a root nearly, a motion that the input hardly moves or the output hardly shows: choose others, or another "
            "operating range",
        )
    _check_stable(placement.controller, where)


def _check_stable(controller: DirectForm, where: str) -> None:
    """Refuse poles of Q/P outside the unit circle; the root that P(1) = 0 puts at 1 is exact up to rounding."""
    worst = float(np.max(np.abs(controller_poles_z(controller))))
    if worst > 1.0 + 1e-6:
        raise BadInput(
            "controller",
            where,
            f"a pole of its own with |z| = {worst:.4g}",
            "poles within the unit circle",
            "choose faster or slower poles, or another free_degree",
        )


def refined(plant: PlantPolynomials, found: DeltaForm, poles_rad_s: Sequence[complex], free: FreeDegree) -> DeltaForm:
    """The controller `found` after STEPS steps in gamma, in the precision of `plant`: q (n + 1,) in V/rad, p (order,).

    b and a (n + 1,) of `plant` ascend in gamma, poles (n + order,) are in rad/s. `found` must be near: all is linear, but a step as large
    as the controller itself would bring back what its columns round away. Raises numpy's LinAlgError where A and B share a root.
    """
    unknowns = np.asarray(_unknowns(found), dtype=plant.a.dtype)
    for _ in range(STEPS):
        system, missing, sizes = _in_gamma(plant, _form(plant, unknowns), poles_rad_s, free)
        unknowns = unknowns + np.linalg.solve(system, missing) / sizes
    return _form(plant, np.asarray(unknowns, dtype=float))


def _in_gamma(
    plant: PlantPolynomials, found: DeltaForm, poles_rad_s: Sequence[complex], free: FreeDegree
) -> tuple[Array, Array, Array]:
    """The system for what is to be added to the unknowns of `found`, what is missing, and the sizes by which its columns are divided."""
    unknowns = len(found.q) + len(found.p)
    origin = _at(plant, free, np.zeros(unknowns))
    columns = np.stack([_at(plant, free, unit) - origin for unit in np.eye(unknowns)], axis=1)
    missing = np.append(wanted_in_gamma(poles_rad_s, plant.sample_period_s)[:-1], free.value) - _at(
        plant, free, _unknowns(found)
    )
    rows = np.max(np.abs(columns), axis=1)
    system = columns / rows[:, np.newaxis]
    sizes = np.max(np.abs(system), axis=0)
    return np.asarray(system / sizes, dtype=float), np.asarray(missing / rows, dtype=float), sizes


def wanted_in_gamma(poles_rad_s: Sequence[complex], sample_period_s: float) -> Array:
    """Eq (25) in gamma, ascending powers, shape (n + 1,) for poles (n,): gamma_i = exp(s_i Ts) - 1."""
    gamma = np.expm1(np.asarray(poles_rad_s, dtype="clongdouble") * sample_period_s)
    return np.asarray(np.poly(gamma).real[::-1])


def _at(plant: PlantPolynomials, free: FreeDegree, unknowns: Array) -> Array:
    """What these unknowns make of all but the highest power of gamma in A P + B Q, and of the free condition's left side."""
    form = _form(plant, unknowns)
    direct = to_direct(form)
    closed = closed_loop_polynomial(open_loop(plant, form))
    return np.append(closed[:-1], np.dot(free.row(len(form.p), len(form.q)), np.append(direct.p[1:], direct.q)))


def _unknowns(form: DeltaForm) -> Array:
    return np.append(form.q, form.p)


def _form(plant: PlantPolynomials, unknowns: Array) -> DeltaForm:
    count = len(plant.a)
    return DeltaForm(q=unknowns[:count], p=unknowns[count:])
