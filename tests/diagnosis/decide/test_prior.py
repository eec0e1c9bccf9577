"""What is believed before any log: common before rare, no spring that pushes away; and small gaps that nothing explains are none."""

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
import pytest

from blind.calibration.fit import UNLEARNED
from diagnosis.confirmation import confirmed_by
from diagnosis.decide import prior
from diagnosis.decide.weighing import Explanations, weigh
from diagnosis.detect.detection import Detection
from diagnosis.detect.form_scores import FormScores
from diagnosis.detect.linearisation import Scores
from diagnosis.detect.replicas import Tail
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.free_numbers import Free
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.result import Seen
from diagnosis.search.beam import Search
from sim.added_effects import every_effect
from sim.effect import EffectParameter
from tests.plants import bound

EFFECTS = {effect.name: effect for effect in every_effect()}


def prior_odds(
    hypothesis: FittedHypothesis, frictionless: Collection[str] = (), steps: Mapping[str, float] = {}
) -> float:
    return prior.prior_odds(hypothesis, EFFECTS, frictionless, steps)


def fitted(evidence: float = 0.0, **effects: dict[str, float]) -> FittedHypothesis:
    named = {name.replace("__", "."): values for name, values in effects.items()}
    hypothesis = Hypothesis(np.zeros(1), named, np.zeros(2))
    return FittedHypothesis(tuple(named), Fit(hypothesis, 0.0, 0.0, (), np.eye(1), np.zeros(1)), evidence)


def test_a_common_effect_goes_before_a_rare_one_of_the_same_form() -> None:
    tilt = fitted(azimuth__tilt={"m": 0.002, "Phi_0": 0.0})
    wind = fitted(azimuth__wind={"c": 0.002, "Phi_w": 0.0})
    assert prior_odds(tilt) > prior_odds(wind)


def test_a_spring_that_pushes_away_is_less_probable_than_one_that_pulls() -> None:
    pulls, pushes = (fitted(elevation__cable_spring={"k": k, "angle_0": 0.0, "h": 0.0}) for k in (0.002, -0.002))
    assert prior_odds(pulls) > prior_odds(pushes)


def test_a_bearing_that_gives_no_further_than_bristles_is_hardly_a_name() -> None:
    # Truth: up to MOST_GIVEN (0.01 rad) a plant's file leaves open whether an axis gives before it slides.
    little, far = (fitted(azimuth__presliding={"b": 1e-4, "z_0": z_0}) for z_0 in (0.01, 0.03))
    assert prior_odds(far) - prior_odds(little) > 8.0


def test_a_constant_force_belongs_to_joints_that_gravity_pushes() -> None:
    carriage, turntable = (fitted(**{f"{axis}__offset_force": {"offset": 0.1}}) for axis in ("carriage", "azimuth"))
    assert prior_odds(carriage) > prior_odds(turntable)


@pytest.mark.parametrize(("tau_s", "further"), [(0.99, 0.0), (1.0, 4.5), (0.0, 0.0)])
def test_a_size_at_the_end_of_its_range_is_rather_something_else(tau_s: float, further: float) -> None:
    # A lag of a second beside air of 0.9 rad/s per root second followed a torque that drifted, 1.6e3 nats better than no lag.
    usual, asked = (fitted(psi_sensor__lag={"tau": value}) for value in (0.02, tau_s))
    lag = EffectParameter("tau", "s", 0.0, 1.0, 0.02, 0.0)
    free = replace(asked, fit=replace(asked.fit, free=(Free("psi_sensor.lag", lag, 0.02),)))
    assert prior_odds(usual) - prior_odds(free) == pytest.approx(further)


def test_a_delay_shorter_than_unseen_losses_leave_is_no_second_effect() -> None:
    # Losses that nobody sees make commands late by a share of a frame; beside lost frames only a longer delay is one of its own.
    def odds(tau_s: float) -> float:
        return prior_odds(fitted(loop__dropped_frames={"p": 0.2}, loop__delay={"tau": tau_s}))

    assert odds(0.0005) < odds(0.02) - 5.0
    assert odds(0.02) == prior_odds(fitted(loop__delay={"tau": 0.0005})) + prior_odds(
        fitted(loop__dropped_frames={"p": 0.2})
    )


def test_a_cyclic_error_of_less_than_half_a_count_is_the_rounding_itself() -> None:
    # Truth: rounding to steps of q is a sawtooth of the angle, whose first sine is of q / pi; read at a steady speed, it beats slowly.
    step_rad = 2e-3
    small, large = (
        fitted(phi_sensor__cyclic={"amplitude": a, "waves": 5.0, "phase": 0.0}) for a in (step_rad / np.pi, -step_rad)
    )
    assert prior_odds(small, steps={"phi_sensor": step_rad}) < prior_odds(large, steps={"phi_sensor": step_rad}) - 5.0
    assert prior_odds(small, steps={"phi_sensor": 0.0}) == prior_odds(large)


def test_friction_one_way_only_is_rarer_where_none_is_stated() -> None:
    # Truth: twice the friction one way only is the same both ways beside a pull, which gravity's own moment takes over.
    one_way, both = fitted(azimuth__friction_asymmetry={"difference": 4e-4}), fitted(azimuth__coulomb={"b": 2e-4})
    assert prior_odds(one_way, ["azimuth"]) < prior_odds(both, ["azimuth"]) - 1.0
    assert prior_odds(one_way, ["elevation"]) == prior_odds(both, ["elevation"])


def test_friction_that_one_way_adds_is_none_where_none_is_stated() -> None:
    # Truth: (d/2) (sgn v + 1) sgn v is (d/2) sgn v beside a pull of d/2: the two have one likelihood, and the pull goes into another.
    even, one_way = (fitted(azimuth__friction_asymmetry={"difference": 4e-4, "e": e}) for e in (0.0, 1.0))
    assert prior_odds(one_way, ["azimuth"]) < prior_odds(even, ["azimuth"]) - 5.0
    assert prior_odds(one_way, ["elevation"]) == prior_odds(even, ["elevation"])


def seen(largest: float, p: float = 1e-4) -> Seen:
    """A gap of that many nats that chance makes with a probability of p."""
    empty = Scores(np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    detection = Detection(p, Tail(5.0, 1.0), largest, False, FormScores((), empty, np.zeros(0)))
    return Seen(object(), None, fitted(), object(), (), None, detection)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("largest", "evidence", "sure", "gap"),
    [(20.0, 3.0, True, False), (20.0, 12.0, True, True), (20.0, 12.0, False, False), (200.0, 3.0, False, True)],
)
def test_a_small_gap_needs_an_explanation(largest: float, evidence: float, sure: bool, gap: bool) -> None:
    # Without a gap, evidence of x nats has a chance of exp(-x) at most: 3 nats are nothing, 12 nats are 6e-6, but for an effect whose
    # size may be zero they say nothing.
    nothing = fitted()
    linearisation = object()
    found = Search(
        (fitted(evidence, azimuth__tilt={"m": 0.1, "Phi_0": 0.0}), nothing), nothing, sure, linearisation, ()
    )  # type: ignore[arg-type]
    assert (confirmed_by(seen(largest), found, None).detection.p <= 0.01) is gap


@pytest.mark.parametrize(("first", "second_counts"), [("psi_sensor.quantization", True), ("main_input.lag", False)])
def test_what_a_sensor_s_steps_gain_makes_what_is_beside_them_no_less_sure(first: str, second_counts: bool) -> None:
    # Truth: steps that are read off the log to a thousandth are exact, and 150 nats beside them are as many as alone. A lag that gains
    # 40000 nats is a form, and what it lacks of the truth may gain as much.
    one = fitted(40000.0, **{first.replace(".", "__"): EFFECTS[first].absent})
    both = fitted(40150.0, **{first.replace(".", "__"): EFFECTS[first].absent, "elevation__cable_spring": {"k": 0.003}})
    found = weigh(Explanations((both, one), fitted(), effect_library(bound("ce150")), 10.0), {}, law=UNLEARNED)
    assert (found.fitted[0] is both) is second_counts


def test_friction_that_falls_beyond_usual_motion_is_rather_dry_friction() -> None:
    # Axes of this rig turn about 1 rad/s: one that falls at 0.1 rad/s is Stribeck's, one at 0.8 rad/s is none.
    falls, flat = (fitted(azimuth__stribeck={"b_s": 1e-3, "v_s": v_s, "e": 2.0}) for v_s in (0.1, 0.8))
    rubs = fitted(azimuth__coulomb={"b": 1e-3})
    assert prior_odds(rubs) - 2.0 < prior_odds(falls) < prior_odds(rubs)
    assert prior_odds(flat) < prior_odds(rubs) - 5.0
