"""The fuzzy controllers: 90 and 18 rules, max-min and centroid as written out with NumPy, and the slips of the paper mended."""

import numpy as np
import pytest

from controllers.equations.exact import Doubles
from controllers.equations.frame import numbers_of
from controllers.fuzzy import Fuzzy
from controllers.fuzzy_sets import AZIMUTH, ELEVATION, ERROR_LABELS, SHOULDER_FOOT, Wording
from sim.simulate import Conditions, simulate
from tests.controllers.rows import ce150, designed
from verification.comparison.manoeuvres import FIGURES
from verification.comparison.measures import merit
from verification.flown_law import FlownLaw

WORDS = {"elevation": ELEVATION, "azimuth": AZIMUTH}


@pytest.mark.parametrize(("axis", "rules"), [("elevation", 90), ("azimuth", 18)])
def test_the_rules_are_as_many_as_the_paper_s(axis: str, rules: int) -> None:
    assert sum(len(row) for table in WORDS[axis].rules.values() for row in table.values()) == rules
    assert len(designed("fuzzy")[1].axis(axis).gains.rules) == rules


@pytest.mark.parametrize("axis", ["elevation", "azimuth"])
def test_inference_is_max_min_and_centroid_of_a_fine_grid(axis: str) -> None:
    # Truth: Mamdani's rule written out on 16 001 points of the output's axis; tolerance 1.5 % of that axis, what the coarse nodes leave.
    _, table = designed("fuzzy")
    gains = numbers_of(table, float).axes[table.index(axis)].gains
    fuzzy, decisions, rng = Fuzzy(), Doubles(), np.random.default_rng(4)
    for _ in range(40):
        region, rate, error = rng.uniform(-40, 40), rng.uniform(-12, 12), rng.uniform(-60, 60) * rng.uniform() ** 2
        strengths = fuzzy._strengths(gains, decisions, 0.0, (region, rate, error))
        found = fuzzy._centroid(gains, decisions, 0.0, strengths)
        assert found == pytest.approx(_mamdani(WORDS[axis], region, rate, error), abs=0.06)


def _mamdani(words: Wording, region: float, rate: float, error: float) -> float:
    """The controller's answer by the book."""
    u = np.linspace(-2.0, 2.0, 16_001)
    names = sorted(words.outputs, key=lambda name: words.outputs[name])
    peaks = [words.outputs[name] for name in names]
    level = np.zeros(u.size)
    for place, table in words.rules.items():
        for sign, row in table.items():
            for label, output in zip(ERROR_LABELS, row, strict=True):
                asked = _degree(words.rate[sign], rate) if label in ("N", "P") else 1.0
                strength = min(_degree(words.regions[place], region), asked, _degree(words.error[label], error))
                shape = np.interp(u, peaks, np.eye(len(peaks))[names.index(output)])
                level = np.maximum(level, np.minimum(strength, shape))
    return float(np.sum(u * level) / np.sum(level)) if np.any(level) else 0.0


def _degree(sides: tuple[float, float, float, float], x: float) -> float:
    a, b, c, d = sides
    rising = 1.0 if b <= -SHOULDER_FOOT else (x - a) / (b - a)
    falling = 1.0 if c >= SHOULDER_FOOT else (d - x) / (d - c)
    return float(np.clip(min(rising, falling), 0.0, 1.0))


def test_every_output_that_a_rule_asks_for_has_a_set() -> None:
    for words in WORDS.values():
        assert {label for table in words.rules.values() for row in table.values() for label in row} <= set(
            words.outputs
        )


@pytest.mark.parametrize("region", [-35.0, -25.0, 0.0, 15.0, 35.0])
def test_a_big_positive_error_at_rest_asks_for_a_positive_voltage_and_its_mirror_for_a_negative_one(
    region: float,
) -> None:
    gains = numbers_of(designed("fuzzy")[1], float).axes[0].gains
    for error, sign in ((35.0, 1.0), (-35.0, -1.0)):
        strengths = Fuzzy()._strengths(gains, Doubles(), 0.0, (region, 0.0, error))
        assert sign * Fuzzy()._centroid(gains, Doubles(), 0.0, strengths) > 0.05


@pytest.mark.parametrize("psi_deg", [-35.0, -25.0, 0.0, 15.0, 25.0, 40.0])
def test_at_every_elevation_a_small_error_is_answered_more_strongly_than_the_arm_falls(psi_deg: float) -> None:
    # Truth: the voltage of rest changes by du_M0/dPsi a radian; a weaker answer to an error of 1 deg cannot hold an unstable arm.
    table = designed("fuzzy")[1].axes[0]
    falls_V = -np.polynomial.Polynomial(table.feedforward_V).deriv()(np.radians(psi_deg)) * np.radians(1.0)
    gains = numbers_of(designed("fuzzy")[1], float).axes[0].gains
    strengths = Fuzzy()._strengths(gains, Doubles(), 0.0, (psi_deg, 0.0, 1.0))
    assert gains.output_V * Fuzzy()._centroid(gains, Doubles(), 0.0, strengths) > 1.5 * max(falls_V, 0.0)


def test_the_elevation_settles_across_the_horizontal() -> None:
    # Truth: the paper's own claim of errors of 0.5 to 1 deg, here within 4 s of each step from -30 to 30 deg (Fig. 13 of seed 000).
    row, table = designed("fuzzy")
    plan = FIGURES["fig-13"].manoeuvre(ce150(), 0.01)
    law = FlownLaw(row.generate(table))
    runs = simulate(ce150(), plan.t_s, plan.x0, law.controller(plan.t_s.size), Conditions(reference=plan.reference_rad))
    found = merit(plan.t_s, plan.reference_rad, runs.y, runs.u, 0)
    assert found.settling_s is not None
    assert found.settling_s < 4.0
    assert np.degrees(found.steady_error_rad) < 0.5
