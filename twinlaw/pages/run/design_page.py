"""A design as a page: where its poles lie, its margins, its coefficients over the elevation, and what storing them does."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from design.pole_placement import INTEGRAL
from design.report import AxisReport, DesignReport
from records.loops import Loop
from records.quality import Colour, Quality, flag
from records.text.units import shown, unit_of
from twinlaw.pages.page import Page, Section, Table
from twinlaw.pages.plots import BLACK, BLUE, EMPTY, GREEN, GREY, ORANGE, RED, Curve, Panel, grid, row, stack
from twinlaw.pages.quality import quality_section, quality_sentence
from twinlaw.pages.run.design import design_heading, design_rows, scheduled_over

Array = NDArray[np.float64]
FINE = 200  # angles at which a fit is drawn
LOOKS = ((BLUE, "-"), (ORANGE, "--"), (GREEN, "-."), (RED, ":"))  # of the loops, which are four at most


def design_page(plant: str, report: DesignReport, digest: str) -> Page:
    """The whole page of `twinlaw design`; a design that does not keep its margins is refused, so there is no page of one."""
    where = f"at {len(report.psi_rad)} points of the schedule" if report.is_scheduled else "at rest"
    held = f"stable, and no margin below the plant file's, {where}, as its {report.arithmetic} table flies"
    quality = Quality((flag(held, Colour.GREEN),))
    return Page(
        title=f"{plant}: the controller as designed",
        verdict=f"The design is {held}.",
        colour=quality.colour,
        why=quality_sentence(quality),
        facts=(("Controller table", digest),),
        sections=(*design_sections(report), quality_section(quality)),
    )


def design_sections(report: DesignReport) -> tuple[Section, ...]:
    """What a design is, for the report of a run as well."""
    return _poles(report), _margins(report), _coefficients(report), _migration(report)


def _poles(report: DesignReport) -> Section:
    panels = [_pole_panel(axis) for axis in report.axes]
    where = f"one of {len(report.psi_rad)} points of the schedule" if report.is_scheduled else "the rest point"
    return Section(
        "Closed-loop poles before and after fit and rounding",
        (f"Each dot is a pole at {where}; the crosses are the poles that were asked for.",),
        plots=(row(panels, ["real part [rad/s]"] * len(panels)),),
    )


def _pole_panel(axis: AxisReport) -> Panel:
    def curve(poles: NDArray[np.complex128], label: str, colour: str, marker: str, size: float = 4.0) -> Curve:
        return Curve(poles.real.ravel(), poles.imag.ravel(), label, colour, "", marker, size)

    return Panel(
        f"{axis.axis}: imaginary part [rad/s]",
        (
            curve(axis.poles_fitted_rad_s, "after the fit", ORANGE, "o"),
            curve(axis.poles_flown_rad_s, "after rounding, as they fly", BLUE, "."),
            curve(np.array(axis.poles_rad_s), "designed", BLACK, "x", 8.0),
        ),
    )


def _margins(report: DesignReport) -> Section:
    told = f"Of the {report.arithmetic} table, as it flies."
    table = Table(design_rows(report), design_heading(report))
    if not report.is_scheduled:
        return Section("Margins", (told,), (table,))
    psi_deg = shown(report.scheduled_by)[1] * report.psi_rad
    alone = len(report.axes) == 1

    def panel(label: str, figure: str, scale: float) -> Panel:
        curves = [
            Curve(
                psi_deg,
                scale * np.array([getattr(m, figure) for m in axis.margins]),
                "" if alone else axis.axis,
                colour,
                dash,
            )
            for axis, (colour, dash) in zip(report.axes, LOOKS, strict=False)
        ]
        return Panel(label, curves)

    coupled = Curve(psi_deg, report.coupled_slowest_rad_s, "" if alone else "all loops", GREY)
    panels = (
        panel("largest sensitivity Ms [-]", "sensitivity", 1.0),
        panel("phase margin [deg]", "phase_rad", 180.0 / math.pi),
        panel("delay margin [ms]", "delay_s", 1e3),
        Panel("slowest pole [rad/s]", (coupled,)),
    )
    return Section(
        f"Margins over {scheduled_over(report)}",
        (told if alone else f"{told} The last panel closes all loops on the whole plant, cross-coupling included.",),
        (table,),
        (stack(panels, _schedule_label(report), panel_height_in=1.7),),
    )


def _schedule_label(report: DesignReport) -> str:
    loop = report.loop(report.angle)
    named = " ".join(dict.fromkeys((report.angle, loop.symbol)))  # an axis is often called as its angle is
    return f"{named} [{shown(loop.output)[0]}]"


def _coefficients(report: DesignReport) -> Section:
    if not report.is_scheduled:
        return _constants(report)
    worst = [f"{_small(report.loop(axis.axis), axis.feedforward_error_V)} ({axis.axis})" for axis in report.axes]
    return Section(
        f"Coefficients over {scheduled_over(report)}",
        (
            f"The law's coefficients in powers of delta = 1 - z^-1, and the input of the operating point: dots as designed at each of "
            f"{len(report.points_rad)} operating points, lines as fitted by one polynomial each. {_at_rest(report)} The fit of u_ff is "
            f"off by at most {' and '.join(worst)}.",
        ),
        (),
        (coefficient_plot(report),),
    )


def _constants(report: DesignReport) -> Section:
    rows = []
    for axis in report.axes:
        which = dict.fromkeys(_which(axis))
        rows += [
            (axis.axis, *_named(report.loop(axis.axis), *one), f"{_values(axis, *one)[1][0]:.7g}") for one in which
        ]
    return Section(
        "Coefficients",
        (
            "The law's coefficients in powers of delta = 1 - z^-1, and the input of the rest point; constants, as the law goes by no "
            f"schedule. {_at_rest(report)}",
        ),
        (Table(rows, ("loop", "coefficient", "unit", "value")),),
    )


def _at_rest(report: DesignReport) -> str:
    """What p_0 = P(1) says of an error at rest: of a loop that integrates none stays."""
    stays = [axis.axis for axis in report.axes if axis.free_degree != INTEGRAL]
    integrates = [axis.axis for axis in report.axes if axis.axis not in stays]
    if not stays:
        return "p_0 = P(1) is 0 everywhere, as the law integrates."
    whose = f" of {' and '.join(stays)}" if integrates else ""
    return f"p_0 = P(1){whose} is not 0: the law does not integrate there, and what its feed-forward misses stays as an error at rest."


def _small(loop: Loop, value: float) -> str:
    return f"{1e3 * value:.2g} mV" if loop.input_unit == "V" else f"{value:.2g} {unit_of(loop.input)}".rstrip()


def coefficient_plot(report: DesignReport) -> str:
    """q_i, p_i and u_ff of all loops over the schedule, as SVG text; a loop of fewer states leaves its place empty."""
    axes = report.axes
    which = sorted(
        {one for axis in axes for one in _which(axis)}, key=lambda one: (("q", "p", "u_ff").index(one[0]), one[1])
    )
    lines = [[_coefficient(report, axis, *one) if _has(axis, *one) else EMPTY for axis in axes] for one in which]
    return grid(lines, [axis.axis for axis in axes], _schedule_label(report), height_in=1.3)


def _has(axis: AxisReport, of: str, place: int) -> bool:
    return of == "u_ff" or place < len(getattr(axis.schedule, of))


def _which(axis: AxisReport) -> list[tuple[str, int]]:
    """All but what is 0 at every elevation, as p_0 = P(1) of a law that integrates."""
    fitted = [(of, place, values) for of in "qp" for place, values in enumerate(getattr(axis.schedule, of))]
    return [*((of, place) for of, place, values in fitted if any(values)), ("u_ff", 0)]


def _coefficient(report: DesignReport, axis: AxisReport, of: str, place: int) -> Panel:
    fine = np.linspace(report.points_rad[0], report.points_rad[-1], FINE)
    designed, fitted = _values(axis, of, place)
    name, unit = _named(report.loop(axis.axis), of, place)
    return Panel(
        f"{name} [{unit}]",
        _fit(
            shown(report.scheduled_by)[1],
            report.points_rad,
            designed,
            fine,
            np.asarray(polyval(fine, fitted), dtype=float),
        ),
    )


def _values(axis: AxisReport, of: str, place: int) -> tuple[Array, Sequence[float]]:
    """A coefficient as designed at each operating point, and its polynomial."""
    if of == "u_ff":
        return axis.operating_V, axis.feedforward_V
    return np.array([getattr(design, of)[place] for design in axis.designs]), getattr(axis.schedule, of)[place]


def _named(loop: Loop, of: str, place: int) -> tuple[str, str]:
    """A coefficient's name and unit."""
    volt, per = unit_of(loop.input) or "1", unit_of(loop.output) or "1"
    gain = volt if per == "1" else f"{volt}/({per})" if "/" in per or " " in per else f"{volt}/{per}"
    return ("u_ff", volt) if of == "u_ff" else (f"{of}_{place}", gain if of == "q" else "-")


def _fit(factor: float, points_rad: Array, designed: Array, fine_rad: Array, fitted: Array) -> Sequence[Curve]:
    return (
        Curve(factor * fine_rad, fitted, "fitted", BLUE),
        Curve(factor * points_rad, designed, "designed", ORANGE, "", "o", 3.0),
    )


def _migration(report: DesignReport) -> Section:
    rows = [
        (
            axis.axis,
            m.form,
            m.source,
            m.storage,
            f"{m.slowest.worst_rad_s:.3f} rad/s",
            "yes" if m.slowest.stable else "no",
        )
        for axis in report.axes
        for m in axis.migrations
    ]
    return Section(
        "Why the delta form: where the slowest pole goes when the table is stored",
        (
            "The same controllers in powers of delta = 1 - z^-1 (what is generated) and in powers of z^-1, exact "
            f"{'at every point or fitted' if report.is_scheduled else 'or as kept'}, stored in double, in float32, or printed with few "
            f"digits.{' The worst of all points.' if report.is_scheduled else ''}",
        ),
        (Table(rows, ("axis", "form", "source", "stored as", "slowest pole", "stable")),),
    )
