"""The evolution of a search that is coded, as it is drawn for nine experiments."""

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from identification.stages.estimate import Data
from twinlaw.pages.identify.search import evolution_plot, search_sections
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


def test_a_sum_of_errors_says_what_it_is_a_sum_of_and_an_error_of_nothing_its_unit() -> None:
    found = SimpleNamespace(
        names=("p_FM_0",), bits=(), lower=(-1.0,), upper=(1.0,), values=(0.25,), method="gradient", error=3.0, cpu_s=0.1
    )
    estimates: Any = [SimpleNamespace(name="p_FM_0", unit="N", by_data_sd=0.1)]
    symbols = SimpleNamespace(parameter_symbols=("p_FM_0",))
    truth: Any = SimpleNamespace(model=symbols, p=np.zeros(1))
    for channels, unit in ((("psi_rad",), "deg"), (("thrust_N",), "tenths"), (("psi_rad", "thrust_N"), "deg + tenths")):
        stage: Any = SimpleNamespace(searched=[found], runs=[SimpleNamespace(channels=channels)])
        (section,) = search_sections([(Data("experiment 1, rotor", "rotor"), stage)], truth, "", estimates)
        values, costs = section.tables
        assert values.rows[0][-2:] == ("+0.25 N", "+2.5")
        assert costs.rows[0][2] == f"3 {unit}"
