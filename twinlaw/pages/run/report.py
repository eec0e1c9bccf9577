"""The report of `twinlaw run`: what was designed, what was verified, and how it flew."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from design.report import AxisReport, DesignReport
from records.log import RunLog
from records.verification import Verification
from sim.tracking import Tracking
from toolchain.elf import ImageSizes
from twinlaw.pages.page import Page, Section, Table
from twinlaw.pages.plots import BLACK, BLUE, GREEN, GREY, ORANGE, RED, Curve, Panel, row, stack
from twinlaw.pages.run.checks import size_rows, verification_rows
from twinlaw.pages.run.design import design_heading, design_rows
from twinlaw.pages.run.tracking import TRACKING_HEADING, tracking_rows

Array = NDArray[np.float64]


def run_page(
    plant: str,
    report: DesignReport,
    verification: Verification,
    sizes: ImageSizes,
    log: RunLog,
    tracking: Sequence[Tracking],
    counters: Mapping[str, int],
) -> Page:
    """The whole page."""
    failures = verification.failures
    verdict = "Every check holds, and the firmware image has flown." if not failures else "; ".join(failures)
    return Page(
        title=f"{plant}: from its equations to a flight of the firmware",
        verdict=verdict,
        passed=not failures,
        facts=(("Controller table", verification.table_digest),),
        sections=(
            _flight(log, tracking, counters),
            _verified(verification, sizes),
            _poles(report),
            _margins(report),
            _migration(report),
        ),
    )


def flight_plot(log: RunLog) -> str:
    """Angles with their references, and both inputs, over time, as SVG text."""
    angles = (("elevation Psi", "psi_rad", "psi_ref_rad"), ("azimuth Phi", "phi_rad", "phi_ref_rad"))
    inputs = (("main rotor u_M", "u_M_V", GREEN), ("tail rotor u_T", "u_T_V", RED))
    panels = [
        Panel(
            f"{name} [deg]",
            (
                Curve(log.t_s, np.degrees(log.column(output)), "measured", BLUE),
                Curve(log.t_s, np.degrees(log.column(reference)), "reference", ORANGE, "--"),
            ),
        )
        for name, output, reference in angles
    ]
    panels += [
        Panel(f"{name} [V]", (Curve(log.t_s, log.column(column), "", colour),)) for name, column, colour in inputs
    ]
    return stack(panels, "time [s]")


def _flight(log: RunLog, tracking: Sequence[Tracking], counters: Mapping[str, int]) -> Section:
    faults = [f"{name} {count}" for name, count in counters.items() if count and name != "frames_accepted"]
    return Section(
        "Flight",
        (
            "The nonlinear plant, with encoder steps, dry friction and stops, in the loop with the unmodified firmware image on the "
            "emulated STM32G071: angles go to the board through its serial line, voltages come back, one frame each per sample.",
            "Overshoot and steady error are of an axis' own steps, as its encoder shows them, while the other axis rests; beside "
            "them how far the other axis' steps push it out of rest, how far its input travels, and how often that turns round.",
            f"The board accepted {counters['frames_accepted']} frames and counted {', '.join(faults) or 'no fault of any kind'}.",
        ),
        (Table(tracking_rows(tracking), TRACKING_HEADING),),
        (flight_plot(log),),
    )


def _verified(verification: Verification, sizes: ImageSizes) -> Section:
    return Section(
        "Verification",
        (
            "Equality is of bits: the exact model in Python, the C compiled for this computer, and the same C inside the image on the "
            "target, stepped side by side. The rounding bound is proved, not sampled: " + verification.rounding.method,
        ),
        (
            Table(verification_rows(verification), ("check", "figures", "")),
            Table(size_rows(sizes), ("memory", "bytes", "of")),
        ),
    )


def _poles(report: DesignReport) -> Section:
    panels = [_pole_panel(axis) for axis in (report.elevation, report.azimuth)]
    return Section(
        "Closed-loop poles before and after fit and rounding",
        (f"Each dot is a pole at one of {len(report.psi_rad)} angles; the crosses are the poles that were asked for.",),
        plots=(row(panels, ["real part [rad/s]"] * 2),),
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
    psi_deg = np.degrees(report.psi_rad)

    def panel(label: str, figure: str, scale: float) -> Panel:
        curves = [
            Curve(psi_deg, scale * np.array([getattr(m, figure) for m in axis.margins]), axis.axis, colour, dash)
            for axis, colour, dash in ((report.elevation, BLUE, "-"), (report.azimuth, ORANGE, "--"))
        ]
        return Panel(label, curves)

    panels = (
        panel("largest sensitivity Ms [-]", "sensitivity", 1.0),
        panel("phase margin [deg]", "phase_rad", 180.0 / math.pi),
        panel("delay margin [ms]", "delay_s", 1e3),
        Panel("slowest pole, coupled [rad/s]", (Curve(psi_deg, report.coupled_slowest_rad_s, "both loops", GREY),)),
    )
    return Section(
        "Margins over the elevation",
        (
            f"Of the {report.arithmetic} table, as it flies. The last panel closes both loops on the whole plant, cross-coupling included.",
        ),
        (Table(design_rows(report), design_heading(report)),),
        (stack(panels, "elevation Psi [deg]", panel_height_in=1.7),),
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
        for axis in (report.elevation, report.azimuth)
        for m in axis.migrations
    ]
    return Section(
        "Why the delta form: where the slowest pole goes when the table is stored",
        (
            "The same controllers in powers of delta = 1 - z^-1 (what is generated) and in powers of z^-1 (the paper's eq (22)), exact "
            "at every angle or fitted, stored in double, in float32, or printed with few digits. The worst of all angles.",
        ),
        (Table(rows, ("axis", "form", "source", "stored as", "slowest pole", "stable")),),
    )
