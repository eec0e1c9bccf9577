"""What stands beside the axes of a plot."""

import re

import numpy as np
import pytest

from twinlaw.pages.plots import Curve, Panel, grid


@pytest.mark.parametrize(
    ("ends", "numbers"), [((2.0, 8.0), ["2", "3", "4", "6"]), ((0.05, 120.0), ["0.1", "1", "10", "100"])]
)
def test_ticks_of_a_logarithmic_axis_are_plain_numbers(ends: tuple[float, float], numbers: list[str]) -> None:
    x = np.geomspace(*ends, 20)
    drawn = grid([[Panel("y", [Curve(x, np.zeros(20))], within=(-0.5, 0.5))]], ["title"], "x", log_x=True)
    assert re.findall(r"<text[^>]*>([^<]*)</text>", drawn)[: len(numbers) + 1] == [*numbers, "x"]
