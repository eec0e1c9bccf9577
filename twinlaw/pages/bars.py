"""Bar charts as SVG text: shares over a range, or one bar a name, in the style of all plots."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from twinlaw.pages.margins import arrange
from twinlaw.pages.plots import ORANGE, STYLE, PlainLog, svg


@dataclass(frozen=True)
class Bars:
    """Bars between the `edges` of an abscissa, or one per name where `edges` are names; `within` bounds the ordinate."""

    heights: Sequence[float]
    edges: Sequence[tuple[float, float]] | Sequence[str]
    ylabel: str
    xlabel: str = ""
    colours: Sequence[str] = (ORANGE,)
    log: bool = False
    log_height: bool = False
    within: tuple[float, float] | None = None


def bars(panels: Sequence[Bars], *, height_in: float = 2.4) -> str:
    """Bar charts side by side, as SVG text."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, height_in))
        cells = figure.subplots(1, len(panels), squeeze=False)
        for axes, panel in zip(cells[0], panels, strict=True):
            _draw_bars(axes, panel)
        arrange(figure, cells)
        return svg(figure)


def _by_factors(axis: Any) -> None:
    axis.set_major_formatter(PlainLog())
    axis.set_minor_formatter(PlainLog(minor_thresholds=(1.0, 0.5)))


def _draw_bars(axes: Axes, panel: Bars) -> None:
    colours = [panel.colours[i % len(panel.colours)] for i in range(len(panel.heights))]
    if all(isinstance(edge, str) for edge in panel.edges):
        drawn = axes.bar([str(edge) for edge in panel.edges], panel.heights, color=colours, width=0.7)
        axes.bar_label(drawn, fmt="%.3g", fontsize=8.0)
        axes.margins(y=0.15)
    else:
        left = np.array([float(edge[0]) for edge in panel.edges])
        right = np.array([float(edge[1]) for edge in panel.edges])
        axes.bar(left, panel.heights, right - left, align="edge", color=colours, edgecolor="white", linewidth=0.5)
        axes.locator_params("x", nbins=5)  # three panels a row leave no more room for numbers such as -17.5
    axes.set_ylabel(panel.ylabel)
    axes.set_xlabel(panel.xlabel)
    axes.set_axisbelow(True)
    axes.grid(False, axis="x")
    if panel.log:
        axes.set_xscale("log")
        _by_factors(axes.xaxis)
    if panel.log_height:
        axes.set_yscale("log")
        _by_factors(axes.yaxis)
        low, high = panel.within or (min(panel.heights), max(panel.heights))
        axes.set_ylim(low / 3.0, high * 3.0)
    elif panel.within is not None:
        axes.set_ylim(*panel.within)
