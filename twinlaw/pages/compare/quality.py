"""The colour of a controller: how it flies plants that are not as designed for, and whether its C is its law."""

import math

import numpy as np

from records.loops import Loop
from records.quality import OVERSHOOT, STEADY_ERROR, STEADY_SHARE, Colour, Look, Quality, flag
from twinlaw.pages.compare.comparison import Compared, spread_of


def controller_quality(row: Compared) -> Quality:
    """All axes over the spread plants, and a flag for each check of bits that failed."""
    failed = [flag(text, Colour.RED) for text in row.failures]
    return Quality((*(look for loop in row.loops for look in axis_looks(row, loop)), *failed))


def axis_looks(row: Compared, loop: Loop) -> list[Look]:
    """The worst overshoot and the worst error at rest of all spread plants; a step that does not settle is a flag."""
    axis = loop.axis
    found = spread_of(row.spread, axis)
    lost = f"{axis}: {found.unsettled} of {len(row.spread)} plants have a step that does not settle"
    return [
        OVERSHOOT.look(axis, 100.0 * found.worst_overshoot),
        _steady(row, loop, found.worst_steady_error_rad),
        *([flag(lost, Colour.RED)] if found.unsettled else []),
    ]


def _steady(row: Compared, loop: Loop, error_rad: float) -> Look:
    if loop.output_unit == "rad":
        return STEADY_ERROR.look(loop.axis, math.degrees(error_rad))
    flown = next(iter(row.flights.values()))
    step_rad = float(np.max(np.abs(np.diff(flown.reference_rad[:, row.loops.index(loop)])), initial=0.0))
    return STEADY_SHARE.look(loop.axis, 100.0 * error_rad / step_rad if step_rad else 0.0)
