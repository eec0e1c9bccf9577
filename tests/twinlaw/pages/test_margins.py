"""What is written beside axes stays within its picture and clear of the next axes, though nothing was measured."""

from itertools import combinations

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from twinlaw.pages.margins import LEGEND_POINTS, arrange, names_in
from twinlaw.pages.plots import STYLE

POINT_PX = 100 / 72  # at matplotlib's usual 100 pixels an inch


@mpl.rc_context(STYLE)
def test_numbers_labels_and_names_stay_within_the_picture_and_apart() -> None:
    # Truth: the extents that matplotlib measures once all is drawn; what is estimated may be off by two points.
    figure = Figure(figsize=(9.0, 5.0))
    renderer = FigureCanvasAgg(figure).get_renderer()
    cells = figure.subplots(2, 2, sharex=True, squeeze=False)
    for index, axes in enumerate(cells.ravel()):
        axes.plot([0.0, 1.0], [-1.2e-5 * (1.0, 1e3)[index % 2], 1e-5], label="a name of some length")
        axes.set_ylabel("rms error of psi\n[deg]")
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=LEGEND_POINTS)
    for axes in cells[-1]:
        axes.set_xlabel("time [s]")
    arrange(figure, cells)
    figure.draw_without_rendering()
    boxes = [axes.get_tightbbox(renderer).padded(-2.0 * POINT_PX) for axes in cells.ravel()]
    for box in boxes:
        assert box.x0 > 0.0
        assert box.y0 > 0.0
        assert box.x1 < figure.bbox.x1
        assert box.y1 < figure.bbox.y1
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))


@mpl.rc_context(STYLE)
def test_a_legend_below_has_room_for_its_lines() -> None:
    figure = Figure(figsize=(9.0, 4.0))
    renderer = FigureCanvasAgg(figure).get_renderer()
    cells = figure.subplots(1, 2, squeeze=False)
    names = [f"name {number}" for number in range(9)]
    drawn = [axes.plot(np.arange(2.0), np.arange(2.0)) for axes in cells[0] for _ in range(5)]
    legend = figure.legend([line for (line,) in drawn][:9], names, loc="lower center", ncols=4, fontsize=LEGEND_POINTS)
    arrange(figure, cells, below_in=names_in(len(names), 4))
    figure.draw_without_rendering()
    below = legend.get_window_extent(renderer)
    assert not any(axes.get_tightbbox(renderer).padded(-POINT_PX).overlaps(below) for axes in cells[0])
