"""Where axes stand in a figure, by the length of what is written beside them.

A layout that is measured (matplotlib's constrained one) draws every label three times over, two thirds of a page's time.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from numpy.typing import NDArray

# Room in inches, of what is written in 9 points: left an ordinate's numbers of seven digits and its label of two lines, above their
# common factor, below an abscissa's numbers and label.
LEFT_IN, RIGHT_IN, ABOVE_IN, BELOW_IN = 1.05, 0.15, 0.2, 0.6
TITLE_IN, BETWEEN_IN = 0.2, 0.22
LEAST_IN = 1.0  # of a pair of axes, however long the names beside it
LEGEND_POINTS = 8.0
_AROUND_A_NAME = 4.6  # line, padding and distance of a legend, in sizes of its letters
_LINE_OF_NAMES = 1.6  # from one line of a legend to the next, likewise
_POINTS_PER_IN = 72.0


def arrange(figure: Figure, cells: NDArray[Any], *, titles: bool = False, below_in: float = 0.0) -> None:
    """Place axes (rows, columns) of equal size in their figure; legends stand right of them, `below_in` is kept free under all."""
    width_in, height_in = figure.get_size_inches()
    rows, columns = cells.shape
    beside_in = [max(RIGHT_IN, *(_beside_in(axes) for axes in column)) for column in cells.T]
    above_in, under_in = ABOVE_IN + titles * TITLE_IN, BELOW_IN + below_in
    wide_in = max(LEAST_IN, (width_in - sum(beside_in) - columns * LEFT_IN) / columns)
    high_in = max(LEAST_IN, (height_in - above_in - under_in - (rows - 1) * BETWEEN_IN) / rows)
    lefts_in = LEFT_IN + np.cumsum([0.0, *(wide_in + beside + LEFT_IN for beside in beside_in[:-1])])
    for index, line in enumerate(cells):
        bottom_in = height_in - above_in - (index + 1) * high_in - index * BETWEEN_IN
        for axes, left_in in zip(line, lefts_in, strict=True):
            place = (left_in / width_in, bottom_in / height_in, wide_in / width_in, high_in / height_in)
            axes.set_position(place)


def names_in(names: int, columns: int) -> float:
    """Height of a legend of so many names in columns [in]."""
    return _LINE_OF_NAMES * LEGEND_POINTS / _POINTS_PER_IN * -(-names // columns) + 0.1


def _beside_in(axes: Axes) -> float:
    legend = axes.get_legend()
    return 0.0 if legend is None else _named_in([text.get_text() for text in legend.get_texts()])


def _named_in(names: Sequence[str]) -> float:
    """Width of a legend of these names [in]."""
    letters = FontProperties(size=LEGEND_POINTS)
    widths = (text_to_path.get_text_width_height_descent(name, letters, name.count("$") > 1)[0] for name in names)
    return float(max(widths) + _AROUND_A_NAME * LEGEND_POINTS) / _POINTS_PER_IN
