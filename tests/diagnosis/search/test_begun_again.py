"""Searches that a bent plant or too little noise led astray begin again, as the plant is stated, by a filter that expects any motion."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.search.fitting import once_more, refined
from diagnosis.search.singles import scored_as_stated
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

# Truth: the supply gives no more than 2.1 V, of commands of up to 2.9 V.
LIMIT = {"input.saturation": {"limit": 2.1, "w": 0.05}}


@pytest.fixture(scope="module")
def case() -> Case:
    return arm_case(arm_log(LIMIT, seed=47))


@pytest.fixture(scope="module")
def ended(case: Case) -> FittedHypothesis:
    """The true name, fitted from the arm as stated."""
    begun = fit(case, nominal_hypothesis(case, -1.5).with_effects(LIMIT))
    assert begun is not None
    end = refined(case, as_fitted(case, begun))
    assert end is not None
    return end


def test_a_plant_gone_astray_is_scored_as_stated(case: Case) -> None:
    plain = nominal_fit(case)
    bent = replace(plain, hypothesis=replace(plain.hypothesis, theta=np.full_like(plain.hypothesis.theta, 4.0)))
    seen = scored_as_stated(case, bent)
    assert seen[0].effect == "input.saturation"
    assert seen[0].values["limit"] == pytest.approx(2.1, rel=0.1)
    upright = replace(plain, hypothesis=replace(plain.hypothesis, theta=0.5 * np.ones_like(plain.hypothesis.theta)))
    assert scored_as_stated(case, upright) == []


def test_a_fit_on_a_lower_hill_finds_the_higher_one(case: Case, ended: FittedHypothesis) -> None:
    # Held at a limit that no command reaches and with parameters far off, its noise as small as that of the truth.
    hypothesis = ended.fit.hypothesis
    far = replace(
        hypothesis.with_effects({"input.saturation": {"limit": 2.6, "w": 0.05}}), theta=hypothesis.theta + 3.0
    )
    start = fit(case, far, rounds=0)
    assert start is not None
    found = once_more(case, as_fitted(case, start))
    assert found.evidence == pytest.approx(ended.evidence, abs=3.0)
    assert found.fit.hypothesis.effects["input.saturation"]["limit"] == pytest.approx(2.1, rel=0.02)


def test_a_fit_at_its_end_is_not_made_worse(case: Case, ended: FittedHypothesis) -> None:
    assert ended.evidence <= once_more(case, ended).evidence < ended.evidence + 3.0
