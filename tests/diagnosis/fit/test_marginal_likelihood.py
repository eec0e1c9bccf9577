"""Laplace's evidence is the marginal likelihood: bridge sampling finds the same."""

import pytest

from diagnosis import decisions
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.free_numbers import from_zero
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import effect_library
from sim.bind import BoundPlant
from tests.diagnosis.arm import arm_case, arm_log, settled
from tests.diagnosis.bridge import log_marginal_likelihood
from tests.diagnosis.conftest import Fly
from tests.soak import SOAK, sampled

DRAWS = 1000 if SOAK else 300
AGREE_NATS = 0.3  # hypotheses as many effects are alike to 3 and more (surely_nats)
Effects = dict[str, dict[str, float]]
RUBS: Effects = {"arm.coulomb": {"b": 0.0004}}
OF_AN_ARM: list[Effects] = [
    {},
    RUBS,
    {"arm.quadratic_drag": {"c": 2e-4}},
    {"arm.friction_asymmetry": {"difference": 3e-4}},
    {"arm.cable_spring": {"k": 0.005, "angle_0": 0.3, "h": 0.0}},
    {"rotor.warmup": {"a": 0.15, "T": 4.0, "t_0": 0.0}},
    {"input.saturation": {"limit": 2.1, "w": 0.05}},
]
OF_A_HELICOPTER: list[Effects] = [{}, {"elevation.quadratic_drag": {"c": 0.01}}, {"azimuth.coulomb": {"b": 3e-4}}]


@pytest.mark.parametrize("effects", sampled(OF_AN_ARM, keep=[RUBS]))
def test_laplaces_evidence_is_that_of_bridge_sampling(effects: Effects) -> None:
    case = arm_case(arm_log(effects, seed=21, seconds=14.0))
    assert off_nats(case, settled(case, effects)) == pytest.approx(0.0, abs=AGREE_NATS)


@pytest.mark.soak
@pytest.mark.parametrize("effects", OF_A_HELICOPTER)
def test_of_twenty_five_parameters_it_is_to_less_than_anything_costs(
    plant: BoundPlant, fly: Fly, effects: Effects
) -> None:
    case = make_case(effect_library(plant), [fly(1, effects, rig_seed=3)])
    assert off_nats(case, settled(case, effects)) == pytest.approx(0.0, abs=float(decisions.SHAPE_COST))


def off_nats(case: Case, fitted: FittedHypothesis) -> float:
    """By how much the evidence is more than truth: the integral over parameters and sizes, and SHAPE_COST for each shape."""
    shapes = sum(not from_zero(entry.parameter) for entry in fitted.fit.free)
    truth_nats, sd_nats = log_marginal_likelihood(case, fitted.fit, DRAWS, seed=1)
    assert sd_nats < AGREE_NATS
    return fitted.evidence + decisions.SHAPE_COST * shapes - truth_nats
