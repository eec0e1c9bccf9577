"""Steps of an input to first order: what passes say of them, and where these are asked instead."""

import numpy as np
import pytest

from diagnosis.fit.profile_likelihood import likelihoods
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.search import rough_numbers
from diagnosis.search.near_steps import NearSteps, near_steps
from diagnosis.search.rough_numbers import POLISHING, polished
from tests.diagnosis.arm import LONG_S, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

NAME = "input.quantization"
TRUTH = {"q": 0.33, "h": 0.0, "s": 0.0}


def stepping(around: dict[str, float]) -> tuple[Case, Hypothesis]:
    """A run of the arm behind a driver with steps, and the plant with others `around`."""
    case = arm_case(arm_log({NAME: TRUTH}, seconds=LONG_S))
    return case, nominal_fit(case).hypothesis.with_effects({NAME: around})


def test_passes_say_the_same() -> None:
    # Truth: a pass for each, of steps to a tenth larger and smaller, held and shifted.
    case, there = stepping({"q": 0.32, "h": 0.1, "s": 0.2})
    shapes = [
        {"q": q, "h": h, "s": s} for q in np.linspace(0.29, 0.35, 5).tolist() for h in (0.0, 0.2) for s in (0.0, -0.3)
    ]
    tried = [there.with_effects({NAME: shape}) for shape in shapes]
    near = near_steps(case, there, NAME)
    assert near is not None
    truth = np.array(likelihoods(case, [there, *tried]))
    assert near.log_likelihood == pytest.approx(truth[0])
    assert np.ptp(truth) > 20.0
    np.testing.assert_allclose(near.likelihoods(tried), truth[1:] - truth[0], atol=0.5, rtol=0.05)


def test_what_is_no_steps_of_an_input_or_has_others_behind_it_is_not_told() -> None:
    case, there = stepping(TRUTH)
    for effects in ({"input.saturation": {"limit": 3.0, "w": 0.0}}, {"theta_sensor.quantization": {"q": 0.01}}):
        (name,) = effects
        assert near_steps(case, there.with_effects(effects), name) is None
    assert near_steps(case, there.with_effects({NAME: TRUTH, "input.lag": {"tau": 0.05, "b": 0.0}}), NAME) is None


def test_passes_are_asked_where_one_does_not_bear_out_what_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    # Truth: the likeliest steps by passes, though first order tells the opposite of all.
    case, start = stepping({**TRUTH, "q": 0.33 / 0.9})

    def turned(near: NearSteps, hypotheses: list[Hypothesis]) -> list[float]:
        return [-1e4 * hypothesis.effects[NAME]["q"] for hypothesis in hypotheses]

    found = polished(case, start, NAME, POLISHING)
    monkeypatch.setattr(NearSteps, "likelihoods", turned)
    by_passes = polished(case, start, NAME, POLISHING)
    assert rough_numbers.is_rough(case, NAME)
    truth, other = likelihoods(case, [by_passes, found])
    assert other == pytest.approx(truth, abs=0.5)
    assert found.effects[NAME]["q"] == pytest.approx(0.33, rel=0.01)
