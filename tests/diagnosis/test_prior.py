"""What is believed before any log: common before rare, no spring that pushes away; and small gaps that nothing explains are none."""

import numpy as np
import pytest

from diagnosis.detect import Detection, FormScores
from diagnosis.engine import confirmed_by
from diagnosis.fit import Fit
from diagnosis.ground import Scores
from diagnosis.hypothesis import Supposed
from diagnosis.prior import prior_odds
from diagnosis.replicas import Tail
from diagnosis.search import Search
from diagnosis.trial import Tried


def tried(evidence: float = 0.0, **effects: dict[str, float]) -> Tried:
    named = {name.replace("__", "."): values for name, values in effects.items()}
    supposed = Supposed(np.zeros(1), named, np.zeros(2))
    return Tried(tuple(named), Fit(supposed, 0.0, 0.0, (), np.eye(1), np.zeros(1)), evidence)


def test_a_common_effect_goes_before_a_rare_one_of_the_same_form() -> None:
    tilt = tried(azimuth__tilt={"m": 0.002, "Phi_0": 0.0})
    wind = tried(azimuth__wind={"c": 0.002, "Phi_w": 0.0})
    assert prior_odds(tilt) > prior_odds(wind)


def test_a_spring_that_pushes_away_is_less_probable_than_one_that_pulls() -> None:
    pulls, pushes = (tried(elevation__cable_spring={"k": k, "angle_0": 0.0, "h": 0.0}) for k in (0.002, -0.002))
    assert prior_odds(pulls) > prior_odds(pushes)


def test_a_constant_force_belongs_to_joints_that_gravity_pushes() -> None:
    carriage, turntable = (tried(**{f"{axis}__offset_force": {"offset": 0.1}}) for axis in ("carriage", "azimuth"))
    assert prior_odds(carriage) > prior_odds(turntable)


def test_a_delay_shorter_than_unseen_losses_leave_is_no_second_effect() -> None:
    # Losses that nobody sees make commands late by a share of a frame; beside lost frames only a longer delay is one of its own.
    def odds(tau_s: float) -> float:
        return prior_odds(tried(loop__dropped_frames={"p": 0.2}, loop__delay={"tau": tau_s}))

    assert odds(0.0005) < odds(0.02) - 5.0
    assert odds(0.02) == prior_odds(tried(loop__delay={"tau": 0.0005})) + prior_odds(
        tried(loop__dropped_frames={"p": 0.2})
    )


@pytest.mark.parametrize(
    ("largest", "evidence", "sure", "gap"),
    [(20.0, 3.0, True, False), (20.0, 12.0, True, True), (20.0, 12.0, False, False), (200.0, 3.0, False, True)],
)
def test_a_small_gap_needs_an_explanation(largest: float, evidence: float, sure: bool, gap: bool) -> None:
    # Without a gap, evidence of x nats has a chance of exp(-x) at most: 3 nats are nothing, 12 nats are 6e-6, but for an effect whose
    # size may be zero they say nothing.
    empty = Scores(np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    detection = Detection(1e-6, Tail(5.0, 1.0), largest, FormScores((), empty, np.zeros(0)))
    nothing = tried()
    ground = object()
    found = Search((tried(evidence, azimuth__tilt={"m": 0.1, "Phi_0": 0.0}), nothing), nothing, sure, ground, ())  # type: ignore[arg-type]
    assert (confirmed_by(detection, found, None).p <= 0.01) is gap
