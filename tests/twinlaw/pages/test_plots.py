"""What stands beside the axes of a plot."""

import re

import numpy as np
import pytest

from twinlaw.pages.plots import Curve, Panel, grid, reliability

CORNERS = re.compile(r'id="patch_2">\s*<path d="M (\S+) (\S+)\s*L \S+ \S+\s*L (\S+) (\S+)')


@pytest.mark.parametrize(
    ("ends", "numbers"), [((2.0, 8.0), ["2", "3", "4", "6"]), ((0.05, 120.0), ["0.1", "1", "10", "100"])]
)
def test_ticks_of_a_logarithmic_axis_are_plain_numbers(ends: tuple[float, float], numbers: list[str]) -> None:
    x = np.geomspace(*ends, 20)
    drawn = grid([[Panel("y", [Curve(x, np.zeros(20))], within=(-0.5, 0.5))]], ["title"], "x", log_x=True)
    assert re.findall(r"<text[^>]*>([^<]*)</text>", drawn)[: len(numbers) + 1] == [*numbers, "x"]


def test_a_reliability_diagram_has_as_much_room_across_as_up() -> None:
    # Truth: both of its axes go from 0 to 1, so that their sides are alike to a tenth: what its points are called stands below.
    drawn = reliability([(0.35, 0.4, 16), (0.75, 0.8, 49)])
    left, bottom, right, top = (float(number) for number in CORNERS.search(drawn).groups())  # type: ignore[union-attr]
    assert right - left == pytest.approx(bottom - top, rel=0.1)
