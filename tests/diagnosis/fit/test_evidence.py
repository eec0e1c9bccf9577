"""What a shape costs, by hand."""

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.fit.evidence import evidence
from diagnosis.fit.gauss_newton import Fit, Free
from diagnosis.hypothesis.hypothesis import Hypothesis
from sim.added_effects import library
from sim.bind import BoundPlant


@pytest.mark.parametrize("told", [0.0, 9.0, 9.99])
def test_a_shape_costs_the_same_whatever_the_logs_tell_of_it(plant: BoundPlant, told: float) -> None:
    # A friction of information 100 whose two shapes have 10 each, of which they share `told`: alike where each makes up for the other.
    effect = library(plant)["azimuth.stribeck"]
    size, *shapes = (effect.parameter[name] for name in ("b_s", "v_s", "e"))
    hypothesis = Hypothesis(np.zeros(0), {effect.name: {"b_s": 1e-3, "v_s": 0.1, "e": 1.0}}, np.zeros(2))
    alone = Fit(hypothesis, 50.0, 40.0, (Free(effect.name, size, 1e-3),), np.array([[100.0]]), np.zeros(1))
    information = np.array([[100.0, 0.0, 0.0], [0.0, 10.0, told], [0.0, told, 10.0]])
    free = (*alone.free, *(Free(effect.name, shape, 0.1) for shape in shapes))
    shaped = Fit(hypothesis, 50.0, 40.0, free, information, np.zeros(3))
    assert evidence(shaped, {effect.name: effect}) == pytest.approx(
        evidence(alone, {effect.name: effect}) - 2.0 * decisions.SHAPE_COST
    )
