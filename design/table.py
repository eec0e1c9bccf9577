"""From a plant and wishes to a controller table and the report on it: the entry of the design stage."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.analysis.rounding import FLOAT32, Rounding
from design.gate import check
from design.operating_points import DesignPoints, design_points, rest_V
from design.report import DesignReport, flown_poles, make_report
from design.schedule import COEFFICIENT_DIGITS, NOISE, fit_error, fit_schedule, stored_fit
from design.settings import AxisSettings, DesignSettings
from records.errors import BadInput
from records.loops import Loop
from records.plant import plant_digest
from records.table import AxisLaw, ControllerTable, short
from records.text.units import unit_of
from sim.added_effects import linear_part, without_effects
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint

Array = NDArray[np.float64]


def design(
    bound: BoundPlant, settings: DesignSettings, rounding: Rounding = FLOAT32
) -> tuple[ControllerTable, DesignReport]:
    """The table for `settings` and what is known of it as `rounding` makes it fly.

    Raises BadInput where an operating point cannot be reached or designed for, and when the table is unstable or below a
    margin of `settings.margins` anywhere in the range, naming axis, angle, and pole or margin. Of a plant's effects, it sees those on
    the equations that add no states; where these leave nothing to design on, it sees the nominal plant.
    """
    if not bound.effects:
        return _designed_on(bound, bound, settings, rounding)
    try:
        return _designed_on(linear_part(bound), bound, settings, rounding)
    except BadInput:
        return _designed_on(without_effects(bound), bound, settings, rounding)


def poles_on(
    bound: BoundPlant, settings: DesignSettings, table: ControllerTable, rounding: Rounding = FLOAT32
) -> list[dict[str, Any]]:
    """The entries `poles` of verification.json of a table that exists already, on this plant as `design` sees it; raises BadInput
    where an angle cannot be held at rest."""
    if not bound.effects:
        return flown_poles(bound, settings, table, rounding)
    try:
        seen = linear_part(bound)
        design_points(seen, settings)
        return flown_poles(seen, settings, table, rounding)
    except BadInput:
        return flown_poles(without_effects(bound), settings, table, rounding)


def _designed_on(
    seen: BoundPlant, bound: BoundPlant, settings: DesignSettings, rounding: Rounding
) -> tuple[ControllerTable, DesignReport]:
    """Table and report of `bound` from the linearisation of `seen`, the plant with fewer effects."""
    points = design_points(seen, settings)
    table = make_table(bound, settings, points)
    report = make_report(seen, settings, table, points, rounding)
    check(report, settings)
    return table, report


def make_table(bound: BoundPlant, settings: DesignSettings, points: DesignPoints) -> ControllerTable:
    """The table of the designs at `points`, not yet judged."""
    return ControllerTable(
        plant=bound.plant.name,
        sample_period_s=settings.sample_period_s,
        schedule=settings.schedule,
        axes=tuple(axis_law(bound, settings, points, loop.axis) for loop in settings.loops),
        loops=settings.loops,
        origin=_origin(bound, settings, points),
    )


def axis_law(bound: BoundPlant, settings: DesignSettings, points: DesignPoints, axis: str) -> AxisLaw:
    """The law of one axis, fitted over the designs at `points`."""
    designs = [design.delta for design in points.axes[settings.index(axis)]]
    schedule = fit_schedule(points.psi_rad, designs, settings.degrees(axis), settings.sample_period_s)
    return AxisLaw(
        q_V_rad=schedule.q,
        p=schedule.p,
        a=observer(settings.axis(axis).observer_pole, len(schedule.q) - 1),
        **frame_entries(bound, settings, points.psi_rad, points.equilibria, axis),
    )


def frame_entries(
    bound: BoundPlant, settings: DesignSettings, psi_rad: Array, equilibria: Sequence[OperatingPoint], axis: str
) -> dict[str, Any]:
    """What every controller's table states of an axis, by field: eq (28) fitted over psi_rad (points,), limits, ranges, encoder step."""
    wishes, loop = settings.axis(axis), settings.loop(axis)
    u_min_V, u_max_V = limits_V(bound, loop, wishes)
    return {
        "feedforward_V": stored_fit(psi_rad, rest_V(bound, equilibria, loop), settings.feedforward_degree),
        "prefilter_time_constant_s": wishes.prefilter_time_constant_s,
        "u_min_V": u_min_V,
        "u_max_V": u_max_V,
        "u_safe_V": min(max(0.0, u_min_V), u_max_V),
        "reference_min_rad": wishes.reference_min_rad,
        "reference_max_rad": wishes.reference_max_rad,
        "resolution_rad": bound.plant.sensors[loop.output],
    }


def limits_V(bound: BoundPlant, loop: Loop, wishes: AxisSettings) -> tuple[float, float]:
    """Least and largest value of the loop's input: the plant's, or narrower ones that are wished for.

    Raises BadInput where it has no limit, as then it has no anti-windup either, and for limits beyond the plant's.
    """
    (variable,) = (symbol for symbol in bound.model.inputs if symbol.name == loop.input)
    least, most = bound.limits(variable)
    low = least if wishes.u_min_V is None else wishes.u_min_V
    high = most if wishes.u_max_V is None else wishes.u_max_V
    where, unit = f"plant {bound.plant.name!r}: {loop.input}", unit_of(loop.input)
    if not (math.isfinite(low) and math.isfinite(high)):
        remedy = f"state them in the equations, or as {loop.own('u_min_V')} and {loop.own('u_max_V')} of the loop"
        raise BadInput("input limits", where, f"{low:g} to {high:g} {unit}", "two numbers", remedy)
    if not least <= low < high <= most:
        raise BadInput(
            "input limits", where, f"{low:g} to {high:g} {unit}", f"within {least:g} to {most:g} {unit}", "narrow them"
        )
    return low, high


def observer(pole: float, order: int) -> tuple[float, ...]:
    """a_i of A = (1 - pole z^-1)^order = 1 - z^-1 [(1 - a_0) + a_1 delta + a_2 delta^2 + ..], each the nearest short number.

    With z^-1 = 1 - delta the bracket is (1 - A) / z^-1 = sum_k c_k z^-(k - 1), c_k = -(order over k) (-pole)^k.
    """
    c = [-math.comb(order, k) * (-pole) ** k for k in range(1, order + 1)]
    a = [(-1) ** i * sum(math.comb(k, i) * c[k] for k in range(i, order)) for i in range(order)]
    return tuple(short(value) for value in (1.0 - a[0], *a[1:]))


def _origin(bound: BoundPlant, settings: DesignSettings, points: DesignPoints) -> dict[str, Any]:
    """Plain lists and numbers from which each coefficient of the table can be traced to its operating point."""
    return {
        "plant_digest": plant_digest(bound.plant),
        "model": bound.model.name,
        "coefficient_degree": settings.coefficient_degree,
        "recursion_degree": settings.recursion_degree,
        "feedforward_degree": settings.feedforward_degree,
        "operating_points": [
            {**_angle(settings, float(psi)), "x0": plain(point.x0), "u0_V": plain(point.u0)}
            for psi, point in zip(points.psi_rad, points.equilibria, strict=True)
        ],
        **{loop.axis: _axis_origin(settings, points, loop.axis) for loop in settings.loops},
    }


def _angle(settings: DesignSettings, psi_rad: float) -> dict[str, float]:
    """The scheduling angle of an operating point, by its column."""
    return {} if settings.schedule is None else {settings.loop(settings.schedule.axis).output: psi_rad}


def _axis_origin(settings: DesignSettings, points: DesignPoints, axis: str) -> dict[str, Any]:
    wishes, designs = settings.axis(axis), points.axes[settings.index(axis)]
    deltas = [design.delta for design in designs]
    schedule = fit_schedule(points.psi_rad, deltas, settings.degrees(axis), settings.sample_period_s)
    return {
        "poles_rad_s": [[pole.real, pole.imag] for pole in wishes.placed_rad_s],
        "free_degree": wishes.free_degree,
        "observer_pole": wishes.observer_pole,
        "fit_error": {
            name: plain([value])[0] for name, value in asdict(fit_error(points.psi_rad, deltas, schedule)).items()
        },
        "b": [plain(design.transfer.b) for design in designs],
        "a": [plain(design.transfer.a) for design in designs],
        settings.loop(axis).own("q_V_rad"): [plain(delta.q) for delta in deltas],
        "p": [plain(delta.p) for delta in deltas],
    }


def plain(values: Iterable[float]) -> list[float]:
    """The numbers as the table's own are written, the same on every processor; 0 for what is rounding beside the largest."""
    found = [float(value) for value in values]
    least = NOISE * max(map(abs, found), default=0.0)
    return [float(f"{value:.{COEFFICIENT_DIGITS}g}") if abs(value) > least else 0.0 for value in found]
