"""The evolution of a search that is coded, as it is drawn for nine experiments."""

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from identification.stages.estimate import Data
from twinlaw.pages.identify.search import evolution_plot
from twinlaw.pages.margins import LEGEND_POINTS
from twinlaw.pages.plots import COLOURS

WIDTH_PT = 9.0 * 72.0
LONGEST = "azimuth turned by 90 degrees swings"  # of the CE150's nine
NAME = re.compile(rf'<text[^>]*x="([\d.]+)"[^>]*>({LONGEST} \d)<')


def test_nine_experiments_have_nine_colours_and_their_names_stay_within_the_picture() -> None:
    best = 1e5 - 1e4 * np.exp(-np.arange(150) / 20.0)
    stages: Any = [
        (Data("", f"{LONGEST} {number}"), SimpleNamespace(searched=[SimpleNamespace(bits=(8,), best=best)]))
        for number in range(1, 10)
    ]
    drawn = evolution_plot(stages)
    assert all(colour.lower() in drawn.lower() for colour in COLOURS)
    named = NAME.findall(drawn)
    assert len(named) == 9
    for x_pt, name in named:
        width, _, _ = text_to_path.get_text_width_height_descent(name, FontProperties(size=LEGEND_POINTS), False)
        assert float(x_pt) + width < WIDTH_PT
