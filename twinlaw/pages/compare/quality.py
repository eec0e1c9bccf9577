"""The colour of a controller: how it flies plants that are not as designed for, and whether its C is its law."""

import math

from records.quality import OVERSHOOT, STEADY_ERROR, Colour, Look, Quality, flag
from twinlaw.pages.compare.comparison import Compared, spread_of
from verification.comparison.flights import AXES


def controller_quality(row: Compared) -> Quality:
    """Both axes over the spread plants, and a flag for each check of bits that failed."""
    failed = [flag(text, Colour.RED) for text in row.failures]
    return Quality((*(look for axis in AXES for look in axis_looks(row, axis)), *failed))


def axis_looks(row: Compared, axis: str) -> list[Look]:
    """The worst overshoot and the worst error at rest of all spread plants; a step that does not settle is a flag."""
    found = spread_of(row.spread, axis)
    lost = f"{axis}: {found.unsettled} of {len(row.spread)} plants have a step that does not settle"
    return [
        OVERSHOOT.look(axis, 100.0 * found.worst_overshoot),
        STEADY_ERROR.look(axis, math.degrees(found.worst_steady_error_rad)),
        *([flag(lost, Colour.RED)] if found.unsettled else []),
    ]
