"""Plots as SVG text: axes, units and legends on each, colours that a colour-blind reader tells apart, same bytes for the same data."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Okabe and Ito's palette.
BLACK = "#000000"
BLUE, ORANGE, GREEN, RED, GREY, SKY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#666666", "#56B4E9"

_STYLE: Any = {
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


def stack(panels: Sequence[Panel], xlabel: str, *, panel_height_in: float = 1.9) -> str:
    """Panels one above the other over the same abscissa, as SVG text."""
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(9.0, panel_height_in * len(panels) + 0.5), layout="constrained")
        rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(rows, panels, strict=True):
            _draw(axes, panel)
        rows[-1].set_xlabel(xlabel)
        return _svg(figure)


def row(panels: Sequence[Panel], xlabels: Sequence[str], *, equal: bool = False, height_in: float = 3.6) -> str:
    """Panels side by side with abscissas of their own, as SVG text; `equal` gives both axes one scale (pole maps)."""
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(9.0, height_in), layout="constrained")
        columns = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, panel, xlabel in zip(columns, panels, xlabels, strict=True):
            _draw(axes, panel)
            axes.set_xlabel(xlabel)
            if equal:
                axes.set_aspect("equal", adjustable="datalim")
        return _svg(figure)


def grid(
    lines: Sequence[Sequence[Panel]], titles: Sequence[str], xlabel: str, *, log_x: bool = False, height_in: float = 1.7
) -> str:
    """Lines of panels one above the other over one abscissa, each column with its title, one legend below, as SVG text."""
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(9.0, height_in * len(lines) + 0.8), layout="constrained")
        cells = figure.subplots(len(lines), len(titles), sharex=True, squeeze=False)
        for line, panels in zip(cells, lines, strict=True):
            for axes, panel in zip(line, panels, strict=True):
                _draw(axes, panel, legend=False)
                if log_x:
                    axes.set_xscale("log")
        for axes, title in zip(cells[0], titles, strict=True):
            axes.set_title(title, fontsize=9.0)
        for axes in cells[-1]:
            axes.set_xlabel(xlabel)
        handles = {label: handle for line in cells for axes in line for handle, label in _named(axes)}
        figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=4, fontsize=8.0)
        return _svg(figure)


def _named(axes: Axes) -> list[tuple[Any, str]]:
    return list(zip(*axes.get_legend_handles_labels(), strict=True))


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
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(9.0, height_in), layout="constrained")
        for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
            _draw_bars(axes, panel)
        return _svg(figure)


def reliability(bins: Sequence[tuple[float, float, int]]) -> str:
    """Stated probabilities against the shares that were right: one point a bin (stated, right, count), larger for more cases."""
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(4.2, 4.2), layout="constrained")
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
        axes.legend(loc="lower right")
        return _svg(figure)


class _PlainNumbers(LogFormatter):
    """0.01, 0.1, 1 along an axis that grows by factors: powers of ten would be set by a program for formulas, which takes longer than
    all the rest of a picture."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def _by_factors(axis: Any) -> None:
    axis.set_major_formatter(_PlainNumbers())
    axis.set_minor_formatter(_PlainNumbers(minor_thresholds=(1.0, 0.5)))


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


def _draw(axes: Axes, panel: Panel, *, legend: bool = True) -> None:
    for curve in panel.curves:
        style: Any = {"linestyle": curve.dash, "marker": curve.marker or None, "markersize": curve.marker_size}
        style["linewidth"] = curve.width
        axes.plot(curve.x, curve.y, label=curve.label or None, color=curve.colour, **style)
    for value, label in panel.limits:
        axes.axhline(value, color=GREY, linestyle=":", linewidth=1.0, label=label or None)
    axes.set_ylabel(panel.ylabel)
    if panel.within is not None:
        axes.set_ylim(*panel.within)
    if legend and axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8.0)


def _svg(figure: Figure) -> str:
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    text = stream.getvalue()
    return text[text.index("<svg") :]
