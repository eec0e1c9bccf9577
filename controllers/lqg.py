"""LQG of each loop: a Kalman filter of the output and its moves, and a regulator that moves the input by what that says.

    y, x <- y + l_0 (measured - y), x + l (measured - y)                                 the steady-state Kalman filter          (C.11)
    v = g (k_0 (r - y) - k x),   u = held + v, limited,   w <- (u - held) / g,   held <- u       the regulator                  (C.12)
    x_i <- x_i + x_(i+1) - a_i x_1 + b_i w,   y <- y + x_1                               the sampled plant of n states          (C.13)

x_1 is the output's move in a sample, x_2 .. x_n what will move it later; v is the input's, w that in the output's unit. Written in moves
(Kaminer, Pascoal, Khargonekar and Coleman, Automatica 31, 1995: the D-implementation of scheduled controllers), the law knows no
operating point: at rest x is 0 at any of them, and stays 0 while the coefficients, polynomials in the scheduling output, change. A rest
has v = 0, so y = r: the moves are the integral action. As the filter is told the limited move, nothing winds up. So r is the reference as
it comes: a filter before it would only be slower, but where a slow zero makes quick answers overshoot. The law begins at the operating
point: `held` is the feed-forward there. What the coefficients are at one operating point stands in controllers/lqg_gains.py; each is
fitted over the points by a polynomial of the lowest degree that is within FIT. Most are constants, as g bears what the plant's gain
varies by.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, make_dataclass
from functools import cache
from typing import Any, TypeVar

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from codegen.law_frame import LawNumbers, Sample, polynomial
from controllers.coupled import demand_held_together
from controllers.equations.designing import Points, axis_table, largest_output, law_table
from controllers.equations.equation_controller import EquationController
from controllers.equations.frame import AxisNumbers, Decisions
from controllers.equations.judging import demand_held_at_rest, demand_margins
from controllers.lqg_gains import Gains, Share, Speeds, gains_at, wished_speeds
from controllers.lqg_loop import controller_at, open_loop
from controllers.pid_tuning import SENSITIVITIES
from design.loop import plant_polynomials
from design.obstacles import finite_zeros
from design.schedule import fit, stored_fit
from records.errors import BadInput
from records.law_table import LawTable
from records.table import Polynomial

N = TypeVar("N")
Array = NDArray[np.float64]

FIT = 0.06  # of the largest coefficient of a kind: every power costs cycles, and most coefficients hardly vary
REAL = 1e-6  # of a zero's size, the imaginary part that rounding leaves it
KINDS = ("a", "b", "k", "l", "g", "inverse_g")
# Shares of the wished speed, tried in turn until every loop, the others closed, is robust: |1/(1 + L)| within what a PID gets at most.
# quanser_aero, whose inputs push both axes alike, needs a quarter; a zero to the right, as a drum's level has, a half.
SLOWER = tuple(float(2.0 ** (-step / 4.0)) for step in range(13))
# Then powers of the loops' wished speeds about their mean, tried in turn: where one loop's closing turns the sign of what another's input
# does, as on ce150_velagic, no common speed holds both; the loop that is wished faster must be so by far.
APART = tuple(1.0 + 0.25 * step for step in range(1, 13))
SENSITIVITY = SENSITIVITIES[-1]


@dataclass(frozen=True)
class LqgGains:
    """Polynomials of (C.11) to (C.13), n of `a` and `b`, n + 1 of `k` and `l`, g and 1/g, and what neither y nor x exceeds."""

    a: tuple[Polynomial, ...]
    b: tuple[Polynomial, ...]
    k: tuple[Polynomial, ...]
    l: tuple[Polynomial, ...]  # noqa: E741  # the field's letter
    g_V_rad: Polynomial
    inverse_g_rad_V: Polynomial
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

        a, b, k, l = at(gains.a), at(gains.b), at(gains.k), at(gains.l)  # noqa: E741
        (g_V_rad,), (inverse_g_rad_V,) = at([gains.g_V_rad]), at([gains.inverse_g_rad_V])
        innovation_rad = sample.angle_rad - state.output_rad
        output_rad = state.output_rad + l[0] * innovation_rad
        moves_rad = [
            getattr(state, f"move_{index}_rad") + l[index] * innovation_rad for index in range(1, self.order + 1)
        ]

        held_V = arithmetic.saturate(state.held_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)
        change_rad = k[0] * (state.reference_2_rad - output_rad)
        for gain, move_rad in zip(k[1:], moves_rad, strict=True):
            change_rad = change_rad - gain * move_rad
        wanted_V = held_V + g_V_rad * change_rad
        limited_V: Any = arithmetic.saturate(wanted_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)

        step_rad, first_rad = inverse_g_rad_V * (limited_V - held_V), moves_rad[0]
        for index in range(self.order):
            move_rad = moves_rad[index] - a[index] * first_rad + b[index] * step_rad
            if index + 1 < self.order:
                move_rad = move_rad + moves_rad[index + 1]
            moves_rad[index] = arithmetic.saturate(move_rad, -y_max_rad, y_max_rad, law.zero)
        output_rad = arithmetic.saturate(output_rad + moves_rad[0], -y_max_rad, y_max_rad, law.zero)
        references_rad = (state.reference_1_rad, state.reference_2_rad)
        return self.AxisState(*references_rad, limited_V, output_rad, *moves_rad), limited_V


def design(points: Points) -> LawTable[LqgGains]:
    """All loops at each operating point, fitted over the schedule, at the first speed of SLOWER at which they are robust together.

    Where none is common to them, then at the first power of APART. Raises BadInput naming what they do not hold at the last common one.
    """
    for loop in points.settings.loops:
        demand_held_at_rest(points, loop.axis)
    common = [dict.fromkeys((loop.axis for loop in points.settings.loops), Share(share, 1.0)) for share in SLOWER]
    apart = [shares for shares in (_apart(points, power) for power in APART) if len(set(shares.values())) > 1]
    told: BadInput | None = None
    for shares in (*common, *apart):
        speeds = {axis: wished_speeds(points.settings.axis(axis), share) for axis, share in shares.items()}
        gains = _all_gains(points, speeds)
        refused = _refusal(points, gains)
        if refused is None:
            return _table(points, gains, speeds, shares)
        told = refused if shares is common[-1] else told
    assert told is not None
    raise told


def _table(
    points: Points, gains: Mapping[str, LqgGains], speeds: Mapping[str, Speeds], shares: Mapping[str, Share]
) -> LawTable[LqgGains]:
    axes = {axis: axis_table(points, axis, own, _filter_s(points, axis, speeds[axis])) for axis, own in gains.items()}
    origin = {axis: _origin(points, axis, entry, shares[axis].regulator) for axis, entry in speeds.items()}
    return law_table("lqg", points, axes, origin)


def _apart(points: Points, power: float) -> dict[str, Share]:
    """Each loop's share of its wished speeds where all lie at this power of what they were about their geometric mean."""
    axes = [loop.axis for loop in points.settings.loops]
    wished = np.array([wished_speeds(points.settings.axis(axis), Share(1.0, 1.0)).regulator_rad_s for axis in axes])
    shares = ((wished / np.exp(np.mean(np.log(wished)))) ** (power - 1.0)).tolist()
    return {axis: Share(share, share) for axis, share in zip(axes, shares, strict=True)}


def _filter_s(points: Points, axis: str, speeds: Speeds) -> float:
    """The time constant of the reference's filter [s]: none, but where a real zero lies between -alpha and 0, by which every quick answer
    overshoots (a room whose air is warm before its walls), that of the plant file.
    """
    for plant in points.sampled(axis):
        zeros = np.log1p(finite_zeros(plant_polynomials(plant)).astype(complex)) / plant.sample_period_s
        real = zeros.real[np.abs(zeros.imag) < REAL * np.abs(zeros)]
        if np.any((-speeds.regulator_rad_s < real) & (real < 0.0)):
            return points.settings.axis(axis).prefilter_time_constant_s
    return 0.0


def _all_gains(points: Points, speeds: Mapping[str, Speeds]) -> dict[str, LqgGains]:
    found = {
        axis: [gains_at(plant_polynomials(plant), entry) for plant in points.sampled(axis)]
        for axis, entry in speeds.items()
    }
    order = max(len(entry[0].a) for entry in found.values())
    values = {axis: _values(entry, order) for axis, entry in found.items()}
    per_loop = [_degrees(points, values[axis], entry) for axis, entry in speeds.items()]
    degrees = {kind: np.max([entry[kind] for entry in per_loop], axis=0) for kind in KINDS}
    return {axis: _gains(points, axis, entry, degrees) for axis, entry in values.items()}


def _values(found: Sequence[Gains], order: int) -> dict[str, Array]:
    """Each kind of coefficient at the operating points, (coefficients, points); moves that a loop of fewer states lacks stay 0."""
    g = np.array([[entry.g for entry in found]])
    values = {"g": g, "inverse_g": 1.0 / g}
    for kind, count in {"a": order, "b": order, "k": order + 1, "l": order + 1}.items():
        rows = np.array([getattr(entry, kind) for entry in found]).T
        values[kind] = np.vstack([rows, np.zeros((count - len(rows), len(found)))])
    return values


def _degrees(points: Points, values: Mapping[str, Array], speeds: Speeds) -> dict[str, list[int]]:
    """The lowest degree of each coefficient with which it is within FIT of the largest of its kind.

    Sizes are those that coefficients have in the units in which a move of x_i is one at alpha, or beta for the filter.
    """
    alpha, beta = (speed * points.settings.sample_period_s for speed in vars(speeds).values())
    of_x = {"a": (1.0 / alpha, 1), "b": (1.0 / alpha, 1), "k": (alpha, 0), "l": (1.0 / beta, 0)}
    degrees = {}
    for kind, rows in values.items():
        unit, first = of_x.get(kind, (1.0, 0))
        sized = rows * np.power(unit, np.arange(first, first + len(rows)))[:, np.newaxis]
        degrees[kind] = [_degree(points, row, FIT * float(np.max(np.abs(sized)))) for row in sized]
    return degrees


def _degree(points: Points, values: Array, tolerance: float) -> int:
    most = points.settings.coefficient_degree
    for degree in range(most):
        if np.max(np.abs(polyval(points.psi_rad, fit(points.psi_rad, values, degree)) - values)) <= tolerance:
            return degree
    return most


def _gains(points: Points, axis: str, values: Mapping[str, Array], degrees: Mapping[str, Array]) -> LqgGains:
    a, b, k, l, g, inverse_g = (  # noqa: E741
        tuple(
            stored_fit(points.psi_rad, row, int(degree))
            for row, degree in zip(values[kind], degrees[kind], strict=True)
        )
        for kind in KINDS
    )
    return LqgGains(a, b, k, l, g[0], inverse_g[0], largest_output(points.settings.axis(axis)))


def _refusal(points: Points, gains: Mapping[str, LqgGains]) -> BadInput | None:
    """What names operating point and margin that a loop does not hold, alone or with all others closed."""
    try:
        _judge(points, gains)
    except BadInput as refused:
        return refused
    return None


def _judge(points: Points, gains: Mapping[str, LqgGains]) -> None:
    """Raise BadInput naming operating point and margin that a loop does not hold, alone or with all others closed."""
    settings, sampled = points.settings, {axis: points.sampled(axis) for axis in gains}
    for index, psi_rad in enumerate(points.psi_rad.tolist()):
        controllers = {axis: controller_at(own, psi_rad) for axis, own in gains.items()}
        for axis, controller in controllers.items():
            plant = plant_polynomials(sampled[axis][index])
            demand_margins(settings, settings.place(axis, psi_rad), open_loop(controller, plant))
        demand_held_together(points, index, controllers, SENSITIVITY)


def _origin(points: Points, axis: str, speeds: Speeds, share: float) -> dict[str, Any]:
    wished = [[share * pole.real, share * pole.imag] for pole in points.settings.axis(axis).placed_rad_s]
    rule = "the cheapest regulator and filter whose poles lie left of these, both multiples of the slowest wished pole"
    return {"poles_rad_s": wished, **vars(speeds), "rule": rule}


CONTROLLER = EquationController(
    name="lqg",
    title="LQG: Kalman filter and LQR, scheduled",
    source="ours: what the papers' controllers are to be beaten by",
    plants=(
        "any plant of one to four loops of up to five states, as `ce150`, that holds the margins of [design] over its range, and settles"
    ),
    note=(
        "is a Kalman filter of each loop's output and its moves, and an LQR that moves the input by what the filter says, both designed at "
        "the operating points and scheduled by polynomials. Written in moves it needs no operating "
        "point, integrates, and, as the filter is told the limited voltage, does not wind up; so its references need no filter, "
        "but where a zero slower than the loop makes every quick step overshoot. Both "
        "are the cheapest of a prescribed stability: poles to the right of -alpha go to their mirror images there, all others stay. alpha "
        "is 1.85 times the slowest wished pole for the regulator and 8 times for the filter. Where |1/(1 + L)| of a loop, the others "
        "closed, would pass 3, the regulators of all are slower, as far as an eighth; where that does not do, the faster loop is faster "
        "and the slower one slower. "
        "It begins with the input that holds the plant where it is."
    ),
    equations=lambda table: Lqg(len(table.axes[0].gains.a)),
    gains=LqgGains,
    tables=design,
    template="lqg.c.j2",
)
