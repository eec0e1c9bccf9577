"""Plots as SVG text: axes, units and legends on each, colours that a colour-blind reader tells apart, same bytes for the same data."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter
from numpy.typing import NDArray

from twinlaw.pages.margins import LEGEND_POINTS, arrange, names_in

Array = NDArray[np.float64]

# Okabe and Ito's palette.
BLACK = "#000000"
BLUE, ORANGE, GREEN, RED, GREY, SKY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#666666", "#56B4E9"
PURPLE, YELLOW = "#CC79A7", "#F0E442"
COLOURS = (
    BLUE,
    ORANGE,
    GREEN,
    RED,
    SKY,
    PURPLE,
    BLACK,
    YELLOW,
    GREY,
)  # of curves side by side, as many as the palette has

COLUMNS = 4  # of names in a legend below all panels

STYLE: Any = {
    "svg.hashsalt": "twinlaw",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
}


@dataclass(frozen=True)
class Curve:
    """One line of a panel: abscissa, ordinate, its name in the legend (empty: none) and its colour and dash pattern."""

    x: Array
    y: Array
    label: str = ""
    colour: str = BLUE
    dash: Any = "-"
    marker: str = ""
    marker_size: float = 4.0
    width: float = 1.2  # of the line [pt]


@dataclass(frozen=True)
class Panel:
    """One pair of axes: curves over a common abscissa, and horizontal lines (value, label) for limits; `within` bounds the ordinate."""

    ylabel: str
    curves: Sequence[Curve]
    limits: Sequence[tuple[float, str]] = ()
    within: tuple[float, float] | None = None


EMPTY = Panel("", ())  # a place of a grid where there is nothing to show


def stack(panels: Sequence[Panel], xlabel: str, *, panel_height_in: float = 1.9) -> str:
    """Panels one above the other over the same abscissa, as SVG text."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, panel_height_in * len(panels) + 0.5))
        rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(rows, panels, strict=True):
            _draw(axes, panel)
        rows[-1].set_xlabel(xlabel)
        arrange(figure, rows[:, None])
        return svg(figure)


def row(panels: Sequence[Panel], xlabels: Sequence[str], *, equal: bool = False, height_in: float = 3.6) -> str:
    """Panels side by side with abscissas of their own, as SVG text; `equal` gives both axes one scale (pole maps)."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, height_in))
        columns = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, panel, xlabel in zip(columns, panels, xlabels, strict=True):
            _draw(axes, panel)
            axes.set_xlabel(xlabel)
            if equal:
                axes.set_aspect("equal", adjustable="datalim")
        arrange(figure, columns[None])
        return svg(figure)


def grid(
    lines: Sequence[Sequence[Panel]], titles: Sequence[str], xlabel: str, *, log_x: bool = False, height_in: float = 1.7
) -> str:
    """Lines of panels one above the other over one abscissa, each column with its title, one legend below, as SVG text."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, height_in * len(lines) + 0.8))
        cells = figure.subplots(len(lines), len(titles), sharex=True, squeeze=False)
        for line, panels in zip(cells, lines, strict=True):
            for axes, panel in zip(line, panels, strict=True):
                _draw(axes, panel, legend=False)
                if log_x:
                    axes.set_xscale("log")
                    axes.xaxis.set_major_formatter(PlainLog())
                    axes.xaxis.set_minor_formatter(PlainLog())
        for axes, title in zip(cells[0], titles, strict=True):
            axes.set_title(title, fontsize=9.0)
        for axes in cells[-1]:
            axes.set_xlabel(xlabel)
        handles = {label: handle for line in cells for axes in line for handle, label in _named(axes)}
        figure.legend(list(handles.values()), list(handles), loc="lower center", ncols=COLUMNS, fontsize=LEGEND_POINTS)
        arrange(figure, cells, titles=True, below_in=names_in(len(handles), COLUMNS))
        return svg(figure)


class PlainLog(LogFormatter):
    """Ticks of a logarithmic axis as plain numbers: within one decade most of them bear one, and 4 is read sooner than 4 x 10^0, which is
    besides set by a program for formulas that takes longer than all the rest of a picture."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def _named(axes: Axes) -> list[tuple[Any, str]]:
    return list(zip(*axes.get_legend_handles_labels(), strict=True))


def reliability(bins: Sequence[tuple[float, float, int]]) -> str:
    """Stated probabilities against the shares that were right: one point a bin (stated, right, count), larger for more cases."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.2, 4.2))
        axes = figure.subplots()
        axes.plot([0.0, 1.0], [0.0, 1.0], color=GREY, linestyle="--", label="as stated")
        stated, right, count = np.array(bins, float).reshape(-1, 3).T
        axes.plot(stated, right, color=BLUE)
        axes.scatter(stated, right, s=20.0 + count, color=BLUE, zorder=3, label="cases, the area their number")
        axes.set(
            xlim=(-0.02, 1.04),
            ylim=(-0.02, 1.04),
            xlabel="stated probability of the first answer",
            ylabel="share right",
        )
        handles, names = axes.get_legend_handles_labels()
        figure.legend(handles, names, loc="lower center", ncols=len(names), fontsize=LEGEND_POINTS)
        arrange(figure, np.array([[axes]]), below_in=names_in(len(names), len(names)))
        return svg(figure)


def _draw(axes: Axes, panel: Panel, *, legend: bool = True) -> None:
    if panel is EMPTY:
        axes.set_axis_off()
        return
    for curve in panel.curves:
        style: Any = {"linestyle": curve.dash, "marker": curve.marker or None, "markersize": curve.marker_size}
        style["linewidth"] = curve.width
        axes.plot(curve.x, curve.y, label=curve.label or None, color=curve.colour, **style)
    for value, label in panel.limits:
        axes.axhline(value, color=GREY, linestyle=":", linewidth=1.0, label=label or None)
    axes.set_ylabel(panel.ylabel)
    axes.ticklabel_format(axis="y", useOffset=False)  # a sum above the panel is read by nobody
    if panel.within is not None:
        axes.set_ylim(*panel.within)
    if legend and axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=LEGEND_POINTS)


def svg(figure: Figure) -> str:
    """The figure as SVG text without date or program, drawn once: `savefig` would draw the whole of it a first time only to lay it out."""
    stream, canvas = io.StringIO(), cast(Any, FigureCanvasSVG(figure))
    canvas.print_svg(stream, metadata={"Date": None, "Creator": None})
    text = stream.getvalue()
    return text[text.index("<svg") :]
