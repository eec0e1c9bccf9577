"""The roll-off's trade-off as a section of the report: quiet inputs against how far the axes push each other, over the roll-off pole."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from design.trade_off import TradePoint
from records.table import AXES
from twinlaw.pages.page import Row, Section, Table
from twinlaw.pages.plots import BLUE, ORANGE, Curve, Panel, row

HEADING: Row = ("axis", "roll-off pole", "travel", "reversals", "Ms", "mean |error|", "pushed by the other axis")


def roll_off_section(points: Sequence[TradePoint]) -> tuple[Section, ...]:
    """The section, or none where nothing was traded."""
    if not points:
        return ()
    panels = (
        _panel("travel of the axis' input [V/s]", points, lambda point, axis: point.tracking[axis].activity.travel_V_s),
        _panel(
            "pushed by the other axis [deg]", points, lambda point, axis: math.degrees(point.tracking[axis].push_rad)
        ),
    )
    sentences = (
        "An encoder step passes through the controller's differences; the roll-off pole says how much of it reaches the rotor. The same "
        "design with both axes' roll-off poles moved by one factor, each flown in double precision: further left, an axis gives way "
        "less to the other, and its input gets busier.",
    )
    rows = [_row(point, axis) for axis in AXES for point in points]
    return (
        Section(
            "What the roll-off costs",
            sentences,
            (Table(rows, HEADING),),
            (row(panels, ["roll-off pole, times the design's"] * 2),),
        ),
    )


def _panel(label: str, points: Sequence[TradePoint], figure: Callable[[TradePoint, str], float]) -> Panel:
    x = np.array([point.factor for point in points])
    curves = [
        Curve(x, np.array([figure(point, axis) for point in points]), axis, colour, dash, "o")
        for axis, colour, dash in zip(AXES, (BLUE, ORANGE), ("-", "--"), strict=True)
    ]
    return Panel(label, curves)


def _row(point: TradePoint, axis: str) -> Row:
    tracking = point.tracking[axis]
    return (
        axis,
        f"{point.roll_off_pole_rad_s[axis]:.1f} rad/s",
        f"{tracking.activity.travel_V_s:.2f} V/s",
        f"{tracking.activity.reversals_1_s:.1f} /s",
        f"{point.sensitivity[axis]:.2f}",
        f"{math.degrees(tracking.mean_error_rad):.2f} deg",
        f"{math.degrees(tracking.push_rad):.2f} deg",
    )
