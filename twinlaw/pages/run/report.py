"""The report of `twinlaw run`: what was designed, what was verified, and how it flew."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from design.report import DesignReport
from design.trade_off import TradePoint
from records.log import RunLog
from records.loops import LOOPS, Loop
from records.quality import Colour, flag
from records.text.units import shown, stem, unit_of
from records.verification import Verification
from sim.columns import reference_name
from toolchain.elf import ImageSizes
from twinlaw.pages.page import Page, Section, Table
from twinlaw.pages.plots import BLUE, GREEN, ORANGE, RED, Curve, Panel, stack
from twinlaw.pages.quality import quality_section, quality_told
from twinlaw.pages.run.checks import size_rows, verification_rows
from twinlaw.pages.run.design_page import design_sections
from twinlaw.pages.run.flight import ChainFlight
from twinlaw.pages.run.roll_off import roll_off_section
from twinlaw.pages.run.tracking import TRACKING_HEADING, flight_quality, tracking_rows

Array = NDArray[np.float64]
# The helicopter's columns by what they are of.
_NAMES = {
    "psi_rad": "elevation Psi",
    "phi_rad": "azimuth Phi",
    "u_M_V": "main rotor u_M",
    "u_T_V": "tail rotor u_T",
}

_OF_SEVERAL = (
    "Overshoot and steady error are of a loop's own steps, as its sensor shows them, while the others rest; beside them how far "
    "the others' steps push it out of rest, how far its input travels, and how often that turns round."
)
_OF_ONE = (
    "Overshoot and steady error are of the steps of its reference, as its sensor shows them; beside them how far its input travels, "
    "and how often that turns round."
)


def run_page(
    plant: str,
    report: DesignReport,
    verification: Verification,
    sizes: ImageSizes,
    flight: ChainFlight,
    trade: Sequence[TradePoint],
) -> Page:
    """The whole page: the flight of the image, its verification, and the design."""
    failures = verification.failures
    quality = flight_quality(flight.tracking, [flag(text, Colour.RED) for text in failures])
    verdict = "Every check holds, and the firmware image has flown." if not failures else "; ".join(failures)
    return Page(
        title=f"{plant}: from its equations to a flight of the firmware",
        verdict=verdict,
        colour=quality.colour,
        why=quality_told(quality, flight.cause),
        facts=(("Controller table", verification.table_digest),),
        sections=(
            _flight(flight, report.loops),
            _verified(verification, sizes),
            *design_sections(report),
            *roll_off_section(trade),
            quality_section(quality),
        ),
    )


def flight_plot(log: RunLog, loops: Sequence[Loop] = LOOPS) -> str:
    """Outputs, those of loops with their references, and all inputs, over time, as SVG text."""
    columns, names = log.columns, _NAMES if tuple(loops) == LOOPS else {}
    inputs = [(_told(name, names), name, (GREEN, RED)[index % 2]) for index, name in enumerate(columns.inputs)]
    panels = [
        Panel(
            f"{_told(output, names)} [{shown(output)[0]}]",
            [
                Curve(log.t_s, shown(output)[1] * log.column(name), how, colour, line)
                for name, how, colour, line in (
                    (output, "measured", BLUE, "-"),
                    (reference_name(output), "reference", ORANGE, "--"),
                )
                if name == output or name in log.extra
            ],
        )
        for output in columns.outputs
    ]
    panels += [
        Panel(f"{name} [{unit_of(column) or 1}]", (Curve(log.t_s, log.column(column), "", colour),))
        for name, column, colour in inputs
    ]
    return stack(panels, "time [s]")


def _told(column: str, names: Mapping[str, str]) -> str:
    """The column's name for a reader, from `names` where it has one."""
    return names.get(column, stem(column))


def _flight(flight: ChainFlight, loops: Sequence[Loop]) -> Section:
    counters, tracking = flight.counters, flight.tracking
    faults = [f"{name} {count}" for name, count in counters.items() if count and name != "frames_accepted"]
    return Section(
        "Flight",
        (
            "The nonlinear plant, with its sensors' steps and what dry friction and stops it has, in the loop with the unmodified firmware "
            "image on the emulated STM32G071: what is measured goes to the board through its serial line, inputs come back, one frame each "
            "per sample.",
            *([_OF_SEVERAL] if len(tracking) > 1 else [_OF_ONE]),
            f"The board accepted {counters['frames_accepted']} frames and counted {', '.join(faults) or 'no fault of any kind'}.",
        ),
        (Table(tracking_rows(tracking), TRACKING_HEADING),),
        (flight_plot(flight.log, loops),),
    )


def _verified(verification: Verification, sizes: ImageSizes) -> Section:
    return Section(
        "Verification",
        (
            "Equality is of bits: the exact model in Python, the C compiled for this computer, and the same C inside the image on the "
            "target, stepped side by side. The rounding bound is proved, not sampled: "
            + verification.rounding.method
            + ".",
        ),
        (
            Table(verification_rows(verification), ("check", "figures", "")),
            Table(size_rows(sizes), ("memory", "bytes", "of")),
        ),
    )
