"""The one rule: limits belong to the better colour, the worst decides, and nothing to look at is amber."""

import math

from records.quality import (
    CRITERIA,
    MARGINS,
    MISFIT,
    STEADY_ERROR,
    STEADY_SHARE,
    TRUTH,
    Colour,
    Quality,
    flag,
    missed_percent,
    quality_facts,
)
from twinlaw.pages.quality import quality_rows, quality_sentence


def test_a_figure_has_the_colour_of_the_limit_that_it_keeps() -> None:
    for criterion in CRITERIA:
        assert criterion.green < criterion.amber
        assert criterion.look("x", criterion.green).colour is Colour.GREEN
        assert criterion.look("x", criterion.amber).colour is Colour.AMBER
        assert criterion.look("x", 1.001 * criterion.amber).colour is Colour.RED
        assert criterion.look("x", math.nan).colour is Colour.RED


def test_each_figure_is_told_beside_the_limits_of_its_own_unit() -> None:
    # Truth: an angle rests 6.15 deg off, a level 0.001 % of its step; limits of the first are in deg, of the other in %.
    steady, share = STEADY_ERROR.look("psi_rad", 6.15), STEADY_SHARE.look("h_m", 0.001)
    assert len({criterion.name for criterion in CRITERIA}) == len(CRITERIA)
    rows = [row[2:6] for row in quality_rows(Quality((steady, share)))]
    assert rows == [("6.15 deg", "psi_rad", "0.1 deg", "1 deg"), ("0.001 %", "h_m", "0.5 %", "2 %")]
    assert quality_sentence(Quality((steady,))) == "Red: steady error of psi_rad 6.15 deg, green up to 0.1 deg."
    assert quality_rows(Quality((STEADY_ERROR.look("psi_rad", 6.4e-15),)))[0][2] == "0 deg"


def test_the_worst_of_all_that_was_looked_at_decides() -> None:
    # Truth: a pair that misses 2.7 times its random errors is amber, a parameter 5.9 sd off too, one at a bound red.
    good, pair, off = MISFIT.look("a", 0.3), MISFIT.look("u_M to psi", 2.7), TRUTH.look("b_vE", 5.9)
    assert Quality((good,)).colour is Colour.GREEN
    assert Quality((good, pair, off)).colour is Colour.AMBER
    worst = Quality((good, pair, off, flag("K at a bound", Colour.RED)))
    assert worst.colour is Colour.RED
    assert [look.of for look in worst.reasons] == ["K at a bound", "u_M to psi", "b_vE"]
    assert quality_sentence(worst).startswith("Red: K at a bound; truth of b_vE 5.9 sd, green up to 3.5 sd; misfit")
    assert [row[-1] for row in quality_rows(worst)] == ["amber", "amber", "red"]
    assert quality_facts(worst)["looked_at"][-1] == {
        "criterion": "flag", "of": "K at a bound", "value": None, "unit": "", "colour": "red",
    }  # fmt: skip


def test_a_flight_that_is_outside_its_margins_for_long_is_not_green_though_it_held_three_seconds() -> None:
    assert Quality((MARGINS.look("theta of one", 42.0), MARGINS.look("phi of another", 0.0))).colour is Colour.AMBER


def test_where_there_is_nothing_to_look_at_nothing_is_green() -> None:
    assert Quality().colour is Colour.AMBER
    assert "nothing to judge" in quality_sentence(Quality())


def test_a_free_run_within_its_sensor_s_noise_misses_nothing() -> None:
    assert missed_percent(0.9, 1.0, 1.0) == 0.0
    assert missed_percent(5.0, 3.0, 100.0) == 0.0
    assert math.isclose(missed_percent(5.0, 1.0, 50.0), 100.0 * math.sqrt(24.0) / 50.0)
