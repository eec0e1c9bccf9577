"""The manoeuvres of a comparison drawn: all controllers over one another, angles and voltages."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from records.text.units import shown, unit_of
from twinlaw.pages.compare.comparison import Compared
from twinlaw.pages.plots import BLUE, GREEN, GREY, ORANGE, RED, SKY, Curve, Panel, grid
from verification.comparison.flights import Flown

Array = NDArray[np.float64]
COLOURS = (BLUE, RED, GREEN, ORANGE, SKY, "#CC79A7")
DASHES = ("-", "--", "-.", (0, (5, 1)), (0, (3, 1, 1, 1)), ":")
MOST_POINTS = 1200


def figure_plot(rows: Sequence[Compared], figure: str) -> str:
    """Outputs over their references and all inputs, all controllers, as SVG."""
    flown = {row.row.name: row.flights[figure] for row in rows}
    first = next(iter(flown.values()))
    looks = dict(zip(flown, zip(COLOURS, DASHES, strict=True), strict=False))

    def curves(values: Mapping[str, Array], axis: int, scale: float) -> list[Curve]:
        return [
            Curve(*_thinned(first.t_s, scale * array[:, axis]), name, looks[name][0], looks[name][1])
            for name, array in values.items()
        ]

    outputs = {name: entry.y_rad for name, entry in flown.items()}
    inputs = {name: entry.u_V for name, entry in flown.items()}
    above, below = [], []
    for index, loop in enumerate(rows[0].loops):
        unit, scale = shown(loop.output)
        wanted = Curve(*_thinned(first.t_s, scale * first.reference_rad[:, index]), "reference", GREY, ":")
        above.append(Panel(f"{loop.axis} [{unit}]", [*curves(outputs, index, scale), wanted]))
        commands = sorted(curves(inputs, index, 1.0), key=_travel, reverse=True)
        below.append(Panel(f"{loop.voltage} [{unit_of(loop.input) or '1'}]", commands))
    return grid([(panel,) for panel in (*above, *below)], ("",), "time [s]", height_in=1.9)


def open_loop_plot(flown: Mapping[str, Flown]) -> str:
    """Both angles and both voltages of runs without a controller, side by side, as SVG."""
    degrees = 180.0 / math.pi

    def panels(label: str, values: Mapping[str, Array], scale: float, axis: int) -> tuple[Panel, ...]:
        return tuple(
            Panel(label, [Curve(*_thinned(flown[name].t_s, scale * array[:, axis]))]) for name, array in values.items()
        )

    angles = {name: entry.y_rad for name, entry in flown.items()}
    voltages = {name: entry.u_V for name, entry in flown.items()}
    rows = (
        panels("elevation [deg]", angles, degrees, 0),
        panels("azimuth [deg]", angles, degrees, 1),
        panels("u_M [V]", voltages, 1.0, 0),
        panels("u_T [V]", voltages, 1.0, 1),
    )
    return grid(rows, tuple(flown), "time [s]", height_in=1.6)


def _travel(curve: Curve) -> float:
    """How far its line goes up and down: the busiest is drawn first, so that it hides none."""
    return float(np.abs(np.diff(curve.y)).sum())


def _thinned(t_s: Array, values: Array) -> tuple[Array, Array]:
    """At most MOST_POINTS points with every peak kept: least and largest of each stretch, in their order."""
    length = -(-len(values) // (MOST_POINTS // 2))
    if length < 2:
        return t_s, values
    chosen: set[int] = {0, len(values) - 1}
    for begin in range(0, len(values), length):
        part = values[begin : begin + length]
        chosen |= {begin + int(np.argmin(part)), begin + int(np.argmax(part))}
    rows = np.array(sorted(chosen))
    return t_s[rows], values[rows]
