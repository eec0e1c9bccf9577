"""Effects that are named together have a line each; a number that the data do not tell is not printed."""

import re
from dataclasses import replace

from records.diagnosis import Estimate, RankedHypothesis
from sim.added_effects import library
from tests.twinlaw.pages.diagnose.told import CE150, WORDS, text_of
from twinlaw.pages.diagnose.summary import summary_text


def test_joint_effects_have_a_line_each_and_their_names_once() -> None:
    joint = RankedHypothesis(
        "azimuth.flexible_mode + azimuth.coulomb",
        "mode(torque) on azimuth + torque(sgn phi_dot) on azimuth",
        0.9,
        {
            "azimuth.flexible_mode.gain": Estimate(0.5, 0.1, "-"),
            "azimuth.flexible_mode.zeta": Estimate(0.2, 0.1, "1"),
            "azimuth.coulomb.b": Estimate(1e-4, 1e-5, "N m"),
        },
    )
    told = replace(WORDS, effects=(joint,), found=(), firmware=None)
    page = text_of(told).replace("\u00a0", " ")
    assert page.count("azimuth.flexible_mode") == 1
    assert "<td>gain = 0.50 ± 0.10, zeta = 0.20 ± 0.10</td>" in page
    assert "<td>b = 0.000100 ± 0.000010 N m</td>" in page
    lines = summary_text(told).splitlines()
    assert "gain 0.50 ± 0.10, zeta 0.20 ± 0.10" in lines[2]
    assert re.match(r"  with azimuth.coulomb +b 0.000100 ± 0.000010 N m$", lines[3])


def test_a_number_that_may_be_any_between_its_bounds_is_not_printed() -> None:
    dead = RankedHypothesis(
        "tail_input.deadzone",
        "dead band of u_T_V on tail_input",
        0.9,
        {"d": Estimate(0.01, 0.001, "V"), "w": Estimate(6e-9, 60.0, "1"), "n": Estimate(19.0, 0.1, "rad rad^-1")},
    )
    told = replace(WORDS, effects=(dead,))
    assert "d = 0.0100 ± 0.0010 V, w not told by these data, n = 19.00 ± 0.10 per rad" in text_of(told)
    assert "d 0.0100 ± 0.0010 V, w not told by these data, n 19.00 ± 0.10 per rad" in summary_text(
        told, (), library(CE150)
    )
