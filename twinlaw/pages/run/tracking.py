"""How well a flight tracks its references, as rows of text and for a program."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

from records.quality import OVERSHOOT, STEADY_ERROR, STEADY_SHARE, Colour, Look, Quality, flag
from records.text.units import unit_of, unit_suffix
from sim.tracking import Tracking, left
from twinlaw.pages.measured import settling_text, small
from twinlaw.pages.page import Row
from twinlaw.pages.quality import colour_of
from twinlaw.pages.reach import LONG, MOSTLY, beyond_reach, smaller

TRACKING_HEADING: Row = (
    "tracking",
    "holds",
    "overshoot",
    "settling",
    "steady error",
    "mean |error|",
    "pushed by other loops",
    "input",
    "travel",
    "reversals",
    "",
)


_ROUNDING = 1e-9


def tracking_rows(tracking: Sequence[Tracking]) -> list[Row]:
    """One row per output: worst overshoot, longest time to settle, worst mean error at rest, mean error, push of other loops; its
    input's activity.
    """
    return [
        (
            entry.output,
            str(entry.holds),
            f"{100 * entry.overshoot:.1f} %",
            settling_text(entry.settling_s),
            error_told(entry, entry.steady_error_rad, 3),
            error_told(entry, entry.mean_error_rad),
            error_told(entry, entry.push_rad) if len(tracking) > 1 else "no other loop",
            entry.input,
            f"{small(entry.activity.travel_V_s)} {unit_of(entry.input)}/s",
            f"{entry.activity.reversals_1_s:.1f} /s",
            colour_of(tracking_looks(entry)),
        )
        for entry in tracking
    ]


def left_sentence(tracking: Sequence[Tracking]) -> str:
    """That a flight did not stay with its references, where it did not, or that they lie beyond what an input can do; else empty."""
    gone, beyond = left(tracking), out_of_reach(entry for entry in tracking if _is_red(entry))
    told = f"the flight left its references, {' and '.join(gone)}" if gone else ""
    follows_not = "this controller does not follow them on this plant"
    if beyond:
        return "\n".join((*beyond, *([f"{told}; where smaller ones do not help, {follows_not}"] if told else [])))
    return f"{told}: {follows_not}" if told else ""


def out_of_reach(tracking: Iterable[Tracking]) -> list[str]:
    """That an output's references lie beyond what its input can do, and what makes them smaller, for each that is not green."""
    beyond = ((entry, _beyond(entry)) for entry in tracking)
    return [f"{told}. {smaller(entry.output)}" for entry, told in beyond if told]


def _beyond(entry: Tracking) -> str:
    if entry.is_out_of_reach and any(look.colour is not Colour.GREEN for look in tracking_looks(entry)):
        return beyond_reach(entry.output, entry.input, entry.limit_V, LONG.format(entry.at_limit_s))
    if entry.rest_limit_V is not None and rests_off(entry):
        return beyond_reach(entry.output, entry.input, entry.rest_limit_V, MOSTLY)
    return ""


def _is_red(entry: Tracking) -> bool:
    return any(look.colour is Colour.RED for look in tracking_looks(entry))


def tracking_looks(entry: Tracking) -> tuple[Look, ...]:
    """What of one output's flight is judged; an output without a hold has nothing to judge."""
    if not entry.holds:
        return ()
    return (
        OVERSHOOT.look(entry.output, 100.0 * entry.overshoot),
        _steady(entry),
        *([flag(f"{entry.output} has a step that does not settle", Colour.RED)] if entry.settling_s is None else []),
    )


def error_told(entry: Tracking, value: float, digits: int = 2) -> str:
    """An error as a person reads it: an angle's in degrees, anything else's in its unit, 0 where it is but rounding of the steps."""
    if entry.is_angle:
        return f"{math.degrees(value):.{digits}f} deg"
    return f"{value if value > _ROUNDING * entry.step_rad else 0.0:.3g} {unit_of(entry.output)}".rstrip()


def rests_off(entry: Tracking) -> bool:
    """Whether an output rests further from its reference than a good flight's."""
    return bool(entry.holds) and _steady(entry).colour is not Colour.GREEN


def _steady(entry: Tracking) -> Look:
    if entry.is_angle:
        return STEADY_ERROR.look(entry.output, math.degrees(entry.steady_error_rad))
    return STEADY_SHARE.look(entry.output, 100.0 * entry.steady_error_rad / entry.step_rad if entry.step_rad else 0.0)


def flight_quality(tracking: Sequence[Tracking], further: Sequence[Look] = ()) -> Quality:
    """Of a flight, all outputs together, and what else was looked at."""
    return Quality((*(look for entry in tracking for look in tracking_looks(entry)), *further))


def tracking_facts(tracking: Sequence[Tracking]) -> dict[str, Any]:
    """The same for a program, by output."""
    return {"tracking": {entry.output: _facts(entry) for entry in tracking}}


def _facts(entry: Tracking) -> dict[str, Any]:
    """By names in the units of this output and its input."""
    of_input = unit_suffix(entry.input)
    units = {"_rad": unit_suffix(entry.output), "_V": of_input, "_V_s": f"{of_input}_s".lstrip("_")}

    def own(name: str) -> str:
        ending = next((ending for ending in units if name.endswith(ending)), None)
        return name if ending is None else f"{name.removesuffix(ending)}_{units[ending]}".rstrip("_")

    found = asdict(entry)
    return {
        **{own(name): value for name, value in found.items()},
        "activity": {own(name): value for name, value in found["activity"].items()},
    }
