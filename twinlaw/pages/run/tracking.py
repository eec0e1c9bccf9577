"""How well a flight tracks its references, as rows of text and for a program."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from records.quality import OVERSHOOT, STEADY_ERROR, Colour, Look, Quality, flag
from sim.tracking import Tracking
from twinlaw.pages.measured import settling_text
from twinlaw.pages.page import Row
from twinlaw.pages.quality import colour_of

TRACKING_HEADING: Row = (
    "tracking",
    "holds",
    "overshoot",
    "settling",
    "steady error",
    "mean |error|",
    "pushed by the other axis",
    "input",
    "travel",
    "reversals",
    "",
)


def tracking_rows(tracking: Sequence[Tracking]) -> list[Row]:
    """One row per output: worst overshoot, longest time to settle, worst mean error at rest, mean error, push of the other axis; its
    input's activity.
    """
    return [
        (
            entry.output,
            str(entry.holds),
            f"{100 * entry.overshoot:.1f} %",
            settling_text(entry.settling_s),
            f"{math.degrees(entry.steady_error_rad):.3f} deg",
            f"{math.degrees(entry.mean_error_rad):.2f} deg",
            f"{math.degrees(entry.push_rad):.2f} deg" if len(tracking) > 1 else "no other axis",
            entry.input,
            f"{entry.activity.travel_V_s:.2f} V/s",
            f"{entry.activity.reversals_1_s:.1f} /s",
            colour_of(tracking_looks(entry)),
        )
        for entry in tracking
    ]


def tracking_looks(entry: Tracking) -> tuple[Look, ...]:
    """What of one output's flight is judged; an output without a hold has nothing to judge."""
    if not entry.holds:
        return ()
    return (
        OVERSHOOT.look(entry.output, 100.0 * entry.overshoot),
        STEADY_ERROR.look(entry.output, math.degrees(entry.steady_error_rad)),
        *([flag(f"{entry.output} has a step that does not settle", Colour.RED)] if entry.settling_s is None else []),
    )


def flight_quality(tracking: Sequence[Tracking], further: Sequence[Look] = ()) -> Quality:
    """Of a flight, all outputs together, and what else was looked at."""
    return Quality((*(look for entry in tracking for look in tracking_looks(entry)), *further))


def tracking_facts(tracking: Sequence[Tracking]) -> dict[str, Any]:
    """The same for a program, by output."""
    return {"tracking": {entry.output: asdict(entry) for entry in tracking}}
