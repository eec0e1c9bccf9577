"""LQG of each loop: a Kalman filter of the output and its moves, and a regulator that moves the input by what that says.

    y, x <- y + l_0 (measured - y), x + l (measured - y)                                 the steady-state Kalman filter          (C.11)
    v = k_0 (r - y) - k x,   u = held + v, limited,   v <- u - held,   held <- u                 the regulator                  (C.12)
    x_i <- x_i + x_(i+1) - a_i x_1 + b_i v,   y <- y + x_1                               the sampled plant of n states          (C.13)

x_1 is the output's move in a sample, x_2 .. x_n what will move it later; v is the input's. Written in moves (Kaminer, Pascoal,
Khargonekar and Coleman, Automatica 31, 1995: the D-implementation of scheduled controllers), the law knows no operating point: at rest x
is 0 at any of them, and stays 0 while the coefficients, polynomials in the scheduling output, change. A rest has v = 0, so y = r: the
moves are the integral action. As the filter is told the limited move, nothing winds up. So r is the reference as it comes: the regulator
goes to it as fast as its weights say, and a filter before it would only be slower. The law begins at the operating point: `held` is the
feed-forward there. What the coefficients are at one operating point stands in controllers/lqg_gains.py; each kind is fitted over the
points by polynomials of the lowest degree that is within FIT.
"""

from collections.abc import Mapping
from dataclasses import dataclass, make_dataclass
from functools import cache
from typing import Any, TypeVar

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from codegen.law_frame import LawNumbers, Sample, polynomial
from controllers.equations.designing import Points, axis_table, largest_output, law_table
from controllers.equations.equation_controller import EquationController
from controllers.equations.frame import AxisNumbers, Decisions
from controllers.equations.judging import demand_held_at_rest, demand_margins, demand_stable
from controllers.lqg_gains import Speeds, gains_at, wished_speeds
from controllers.lqg_loop import controller_at, coupled_poles, open_loop
from design.loop import plant_polynomials
from design.schedule import fit, stored_fit
from design.table import plain
from records.errors import BadInput
from records.law_table import LawTable
from records.table import Polynomial

N = TypeVar("N")
Array = NDArray[np.float64]

FIT = 0.08  # of the largest value: every power costs cycles, and most coefficients hardly vary
KINDS = ("a", "b", "k", "l")
# Shares of the wished speed, tried in turn. quanser_aero's loops, whose inputs push both axes alike, hold each other from 0.5 on.
SLOWER = (1.0, 0.7, 0.5, 0.35)


@dataclass(frozen=True)
class LqgGains:
    """Polynomials of (C.11) to (C.13), n of `a` and `b` [rad/V], n + 1 of `k_V_rad` and `l`, and what neither y nor x exceeds."""

    a: tuple[Polynomial, ...]
    b: tuple[Polynomial, ...]
    k_V_rad: tuple[Polynomial, ...]
    l: tuple[Polynomial, ...]  # noqa: E741  # the field's letter
    y_max_rad: float


@cache
def axis_state(order: int) -> Any:
    """The record of what one loop remembers: filtered reference, the held input, the output, its moves."""
    moves = [f"move_{index}_rad" for index in range(1, order + 1)]
    names = ("reference_1_rad", "reference_2_rad", "held_V", "output_rad", *moves)
    return make_dataclass("LqgState", [(name, Any) for name in names], frozen=True)


@dataclass(frozen=True)
class Lqg:
    """The equations of one loop of up to `order` states, name by name and operation by operation as in templates/lqg.c.j2."""

    order: int

    @property
    def AxisState(self) -> Any:
        """See `axis_state`."""
        return axis_state(self.order)

    def axis_rest(
        self,
        law: LawNumbers[N],
        axis: AxisNumbers[N],
        arithmetic: Decisions[N],
        reference_rad: N,
        angle_rad: N,
        schedule_rad: N,
    ) -> Any:
        """The operating point: the input that holds the output where it is, which does not move."""
        rest_V = polynomial(axis.feedforward_V, schedule_rad, law.zero)
        held_V = arithmetic.saturate(rest_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)
        output_rad = arithmetic.clamp(angle_rad, -axis.gains.y_max_rad, axis.gains.y_max_rad)
        return self.AxisState(reference_rad, reference_rad, held_V, output_rad, *[law.zero] * self.order)

    def axis_step(
        self, law: LawNumbers[Any], axis: AxisNumbers[Any], arithmetic: Decisions[Any], state: Any, sample: Sample[Any]
    ) -> tuple[Any, Any]:
        """(C.11), (C.12) with the limits, (C.13)."""
        gains, y_max_rad = axis.gains, axis.gains.y_max_rad

        def at(coefficients: Any) -> list[Any]:
            return [polynomial(entry, sample.schedule_rad, law.zero) for entry in coefficients]

        a, b, k, l = at(gains.a), at(gains.b), at(gains.k_V_rad), at(gains.l)  # noqa: E741
        innovation_rad = sample.angle_rad - state.output_rad
        output_rad = state.output_rad + l[0] * innovation_rad
        moves_rad = [
            getattr(state, f"move_{index}_rad") + l[index] * innovation_rad for index in range(1, self.order + 1)
        ]

        held_V = arithmetic.saturate(state.held_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)
        change_V = k[0] * (state.reference_2_rad - output_rad)
        for gain, move_rad in zip(k[1:], moves_rad, strict=True):
            change_V = change_V - gain * move_rad
        limited_V: Any = arithmetic.saturate(held_V + change_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)

        step_V, first_rad = limited_V - held_V, moves_rad[0]
        for index in range(self.order):
            move_rad = moves_rad[index] - a[index] * first_rad + b[index] * step_V
            if index + 1 < self.order:
                move_rad = move_rad + moves_rad[index + 1]
            moves_rad[index] = arithmetic.saturate(move_rad, -y_max_rad, y_max_rad, law.zero)
        output_rad = arithmetic.saturate(output_rad + moves_rad[0], -y_max_rad, y_max_rad, law.zero)
        references_rad = (state.reference_1_rad, state.reference_2_rad)
        return self.AxisState(*references_rad, limited_V, output_rad, *moves_rad), limited_V


def design(points: Points) -> LawTable[LqgGains]:
    """All loops from Riccati equations at each operating point, fitted over the schedule, at the first speed of SLOWER that they hold.

    Raises BadInput where even at the last one a loop falls below a margin of [design], or all together are unstable.
    """
    for loop in points.settings.loops:
        demand_held_at_rest(points, loop.axis)
    for share in SLOWER:
        speeds = {loop.axis: wished_speeds(points.settings.axis(loop.axis), share) for loop in points.settings.loops}
        gains = _all_gains(points, speeds)
        try:
            _judge(points, gains)
        except BadInput:
            if share == SLOWER[-1]:
                raise
            continue
        axes = {axis: axis_table(points, axis, own, 0.0) for axis, own in gains.items()}
        return law_table("lqg", points, axes, {axis: _origin(entry) for axis, entry in speeds.items()})
    raise AssertionError


def _all_gains(points: Points, speeds: Mapping[str, Speeds]) -> dict[str, LqgGains]:
    values = {axis: _values(points, axis, entry) for axis, entry in speeds.items()}
    order = max(len(entry["a"]) for entry in values.values())
    degrees = {kind: max(_degree(points, entry[kind]) for entry in values.values()) for kind in KINDS}
    return {axis: _gains(points, axis, entry, order, degrees) for axis, entry in values.items()}


def _values(points: Points, axis: str, speeds: Speeds) -> dict[str, Array]:
    """Each kind of coefficient at the operating points, (coefficients, points)."""
    found = [gains_at(plant_polynomials(plant), speeds) for plant in points.sampled(axis)]
    return {kind: np.array([getattr(entry, kind) for entry in found]).T for kind in KINDS}


def _degree(points: Points, values: Array) -> int:
    """The lowest degree that fits each row of values to FIT of its largest."""
    most = points.settings.coefficient_degree
    for degree in range(most):
        errors = [np.max(np.abs(polyval(points.psi_rad, fit(points.psi_rad, row, degree)) - row)) for row in values]
        if all(error <= FIT * np.max(np.abs(row)) for error, row in zip(errors, values, strict=True)):
            return degree
    return most


def _gains(points: Points, axis: str, values: Mapping[str, Array], order: int, degrees: Mapping[str, int]) -> LqgGains:
    """The record of one loop; a loop of fewer states than `order` has moves that stay 0."""

    def fitted(kind: str, count: int) -> tuple[Polynomial, ...]:
        rows = [stored_fit(points.psi_rad, row, degrees[kind]) for row in values[kind]]
        return (*rows, *[(0.0,) * (degrees[kind] + 1)] * (count - len(rows)))

    return LqgGains(
        fitted("a", order), fitted("b", order), fitted("k", order + 1), fitted("l", order + 1),
        largest_output(points.settings.axis(axis)),
    )  # fmt: skip


def _judge(points: Points, gains: Mapping[str, LqgGains]) -> None:
    """Raise BadInput naming operating point and margin that a loop does not hold, or where all of them together are unstable."""
    sampled = {axis: points.sampled(axis) for axis in gains}
    for index, (psi_rad, whole) in enumerate(zip(points.psi_rad.tolist(), points.whole(), strict=True)):
        controllers = {axis: controller_at(own, psi_rad) for axis, own in gains.items()}
        for axis, controller in controllers.items():
            plant = plant_polynomials(sampled[axis][index])
            demand_margins(points.settings, points.settings.place(axis, psi_rad), open_loop(controller, plant))
        together = coupled_poles(whole, tuple(controllers.values()))
        demand_stable("slowest pole of all loops together", points.settings.place("all axes", psi_rad), together)


def _origin(speeds: Speeds) -> dict[str, Any]:
    return {
        "poles_rad_s": [[-speed, 0.0] for speed in plain(vars(speeds).values())],
        "rule": "zero of the weighted error, geometric mean of the regulator's poles, of the filter's",
    }


CONTROLLER = EquationController(
    name="lqg",
    title="LQG: Kalman filter and LQR, scheduled",
    source="ours: what the papers' controllers are to be beaten by",
    plants=(
        "any plant of one to four loops of up to five states, as `ce150`, that holds the margins of [design] over its range, and settles"
    ),
    note=(
        "is a Kalman filter of each loop's output and its moves, and an LQR that moves the input by what the filter says, both from "
        "Riccati equations at the operating points and scheduled by polynomials. Written in moves it needs no operating "
        "point, integrates, and, as the filter is told the limited voltage, does not wind up; so its references need no filter. Its "
        "weights follow from the plant file's poles alone: the regulator's have 0.74 of their geometric mean, the filter's 4.5 times it, "
        "and the error is weighted with its rate over 0.42 of it; these numbers were chosen on sixty spread plants of seed 101, which are "
        "not those below. "
        "It begins with the voltage that holds the arm where it is."
    ),
    equations=lambda table: Lqg(len(table.axes[0].gains.a)),
    gains=LqgGains,
    tables=design,
    template="lqg.c.j2",
)
