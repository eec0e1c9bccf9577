"""A design as rows of text: poles and margins of each axis, for the terminal, for the report and for a program."""

import math
from dataclasses import asdict
from typing import Any

from design.analysis.migration import SlowestPole
from design.report import AxisReport, DesignReport
from records.text.units import digits, said, unit_of
from records.verification import at_own_schedule
from twinlaw.pages.page import Row

_DESIGN_HEADING: Row = (
    "axis",
    "designed",
    "after fit",
    "as {arithmetic}",
    "at {angle}",
    "Ms",
    "phase",
    "gain up / down",
    "delay",
    "fit error q",
)


def design_heading(report: DesignReport) -> Row:
    """The heading of `design_rows`."""
    angle = (report.angle if _is_angle(report) else report.loop(report.angle).symbol) if report.is_scheduled else ""
    return tuple(word.format(arithmetic=report.arithmetic, angle=angle).rstrip() for word in _DESIGN_HEADING)


def scheduled_over(report: DesignReport) -> str:
    """What a scheduled law goes by, in words: an axis means its angle."""
    return f"the {report.angle}" if _is_angle(report) else f"{report.loop(report.angle).symbol} of the {report.angle}"


def _is_angle(report: DesignReport) -> bool:
    return unit_of(report.scheduled_by) == "rad"


def design_rows(report: DesignReport) -> list[Row]:
    """One row per axis: slowest pole designed, worst after fit and rounding, worst of each margin over Psi; then all loops coupled."""
    rows = [_design_row(report, axis) for axis in report.axes]
    if len(rows) == 1:
        return rows
    whose = "both" if len(rows) == 2 else "all"
    coupled = (
        f"{whose}, coupled",
        "",
        "",
        f"{digits(report.coupled.worst_rad_s)} rad/s",
        _where(report, report.coupled.at_psi_rad),
    )
    return [*rows, (*coupled, *[""] * (len(_DESIGN_HEADING) - len(coupled)))]


def _design_row(report: DesignReport, axis: AxisReport) -> Row:
    worst = axis.worst_margins
    return (
        axis.axis,
        f"{digits(axis.designed_slowest_rad_s)} rad/s",
        f"{digits(axis.after_fit.worst_rad_s)} rad/s",
        f"{digits(axis.after_rounding.worst_rad_s)} rad/s",
        _where(report, axis.after_rounding.at_psi_rad),
        f"{worst.sensitivity:.2f}",
        degrees(worst.phase_rad),
        f"{_or_any(worst.gain_up, 2)} / {worst.gain_down:.2f}",
        _or_any(1e3 * worst.delay_s, 0, " ms"),
        f"{100 * axis.fit_error.q:.2g} %",
    )


def _where(report: DesignReport, at: float) -> str:
    return said(report.scheduled_by, at) if report.is_scheduled else "rest"


def design_facts(report: DesignReport) -> dict[str, Any]:
    """The same for a program."""
    axes, column = report.axes, report.scheduled_by if report.is_scheduled else None
    return {
        "arithmetic": report.arithmetic,
        "poles": [at_own_schedule(entry, column) for entry in report.pole_entries()],
        "after_fit": {axis.axis: _slowest(axis.after_fit, column) for axis in axes},
        "fit_error": {axis.axis: asdict(axis.fit_error) for axis in axes},
        "worst_margins": {axis.axis: _finite(asdict(axis.worst_margins)) for axis in axes},
        "coupled": _slowest(report.coupled, column),
    }


def _slowest(pole: SlowestPole, column: str | None) -> dict[str, float]:
    return at_own_schedule({"worst_slowest_rad_s": pole.worst_rad_s, "at_psi_rad": pole.at_psi_rad}, column)


def degrees(angle_rad: float) -> str:
    """An angle as a person reads it."""
    return _or_any(math.degrees(angle_rad), 1, " deg")


def _or_any(margin: float, places: int, unit: str = "") -> str:
    """A margin as a person reads it; one without end forgives any change."""
    return f"{margin:.{places}f}{unit}" if math.isfinite(margin) else "any"


def _finite(values: dict[str, float]) -> dict[str, float | None]:
    """JSON knows no infinity: a margin without end is null."""
    return {key: value if math.isfinite(value) else None for key, value in values.items()}
