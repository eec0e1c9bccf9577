"""The gate: a table that is unstable or below a stated margin anywhere in its range does not leave the design stage."""

from dataclasses import dataclass

import numpy as np

from design.loop import PlantPolynomials
from design.obstacles import margin_advice
from design.report import AxisReport, DesignReport
from design.settings import DesignSettings, MarginLimits
from records.errors import BadInput

MORE = "; or more operating points or a higher coefficient_degree"

# The controller's own poles may reach the unit circle (integral action) but not leave it by more than rounding.
LARGEST_RADIUS = 1.0 + 1e-9


@dataclass(frozen=True)
class _Rule:
    """A figure of merit at one angle that must not exceed `limit` (or fall below it, with `at_least`)."""

    what: str
    values: tuple[float, ...]
    limit: float
    unit: str
    at_least: bool = False


def check(report: DesignReport, settings: DesignSettings) -> None:
    """Raises BadInput naming axis, angle, and pole or margin of the first rule that does not hold."""
    for axis in report.axes:
        for rule in _stability(axis, report.arithmetic):
            _apply(rule, report, settings, axis.axis)
    if report.coupling:
        _check_relative_gains(report, settings)
        slowest = tuple(report.coupled_slowest_rad_s)
        _apply(_Rule("slowest pole of all loops together", slowest, 0.0, "rad/s"), report, settings, "all axes")
    for axis in report.axes:
        for rule in _margin_rules(axis, settings.margins):
            _apply(rule, report, settings, axis.axis, axis.plants)
    if report.coupling:
        _check_coupled_sensitivity(report, settings)


def _check_relative_gains(report: DesignReport, settings: DesignSettings) -> None:
    for index, loop in enumerate(settings.loops):
        gains = [found.relative_gain[index] for found in report.coupling]
        worst, least = int(np.argmin(gains)), settings.margins.min_relative_gain
        if gains[worst] < least:
            raise BadInput(
                f"relative gain from {loop.input} to {loop.output}",
                settings.place(loop.axis, float(report.points_rad[worst])),
                f"{gains[worst]:.3g} at its crossover",
                f"at least {least:g}: below, most of what the input does to this output comes by way of the other loops",
                "pair the loops otherwise, or choose an operating range where they are less coupled",
            )


def _check_coupled_sensitivity(report: DesignReport, settings: DesignSettings) -> None:
    for index, loop in enumerate(settings.loops):
        found = [entry.sensitivity[index] for entry in report.coupling]
        worst, limit = int(np.argmax(found)), settings.margins.max_sensitivity
        if not found[worst] < limit:
            raise BadInput(
                "coupled margin, sensitivity max|1/(1 + L)| with the other loops closed",
                settings.place(loop.axis, float(report.points_rad[worst])),
                f"{found[worst]:.4g}",
                f"below {limit:.4g}",
                "choose slower poles for one of the loops, which lie too near each other for their coupling",
            )


def _stability(axis: AxisReport, arithmetic: str) -> tuple[_Rule, ...]:
    after_fit = tuple(float(row.real.max()) for row in axis.poles_fitted_rad_s)
    after_rounding = tuple(float(row.real.max()) for row in axis.poles_flown_rad_s)
    return (
        _Rule("slowest closed-loop pole after the fit", after_fit, 0.0, "rad/s"),
        _Rule(f"slowest closed-loop pole of the {arithmetic} table", after_rounding, 0.0, "rad/s"),
        _Rule("largest pole |z| of the controller itself", axis.controller_radius, LARGEST_RADIUS, ""),
    )


def _margin_rules(axis: AxisReport, limits: MarginLimits) -> tuple[_Rule, ...]:
    margins = axis.margins
    return (
        _Rule("sensitivity max|1/(1 + L)|", tuple(m.sensitivity for m in margins), limits.max_sensitivity, ""),
        _Rule("phase margin", tuple(m.phase_rad for m in margins), limits.min_phase_margin_rad, "rad", at_least=True),
        _Rule("delay margin", tuple(m.delay_s for m in margins), limits.min_delay_margin_s, "s", at_least=True),
    )


def _apply(
    rule: _Rule, report: DesignReport, settings: DesignSettings, axis: str, plants: tuple[PlantPolynomials, ...] = ()
) -> None:
    """Raises BadInput where the rule does not hold; with the `plants` (angles,) of the axis it says what these leave to be chosen."""
    worst = min(rule.values) if rule.at_least else max(rule.values)
    holds = worst >= rule.limit if rule.at_least else worst < rule.limit
    if holds:
        return
    index = rule.values.index(worst)
    bound = "at least" if rule.at_least else "below"
    more = "" if settings.schedule is None else MORE
    remedy = (
        margin_advice(plants[index], settings.margins.max_sensitivity, more) if plants else f"choose other poles{more}"
    )
    raise BadInput(
        rule.what,
        settings.place(axis, float(report.psi_rad[index])),
        f"{worst:.4g} {rule.unit}".strip(),
        f"{bound} {rule.limit:.4g} {rule.unit}".strip(),
        remedy,
    )
