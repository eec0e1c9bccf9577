"""The gate: a table that is unstable or below a stated margin anywhere in its range does not leave the design stage."""

import math
from dataclasses import dataclass

from design.report import AxisReport, DesignReport
from design.settings import DesignSettings, MarginLimits
from records.errors import BadInput
from records.table import AXES

REMEDY = "choose other poles, more operating points or a higher coefficient_degree"

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
    for name in AXES:
        axis = report.axis(name)
        for rule in _stability(axis, report.arithmetic):
            _apply(rule, report, name)
    _apply(
        _Rule("slowest pole of both loops together", tuple(report.coupled_slowest_rad_s), 0.0, "rad/s"),
        report,
        "both axes",
    )
    for name in AXES:
        for rule in _margin_rules(report.axis(name), settings.margins):
            _apply(rule, report, name)


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


def _apply(rule: _Rule, report: DesignReport, axis: str) -> None:
    worst = min(rule.values) if rule.at_least else max(rule.values)
    holds = worst >= rule.limit if rule.at_least else worst < rule.limit
    if holds:
        return
    psi_deg = math.degrees(report.psi_rad[rule.values.index(worst)])
    bound = "at least" if rule.at_least else "below"
    raise BadInput(
        rule.what,
        f"{axis} at psi = {psi_deg:.1f} deg",
        f"{worst:.4g} {rule.unit}".strip(),
        f"{bound} {rule.limit:.4g} {rule.unit}".strip(),
        REMEDY,
    )
