"""Steps of an input, found where other steps that lie elsewhere or are held longer do nearly the same."""

import numpy as np
import pytest

from diagnosis.explain.improved import estimates
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.search.rough_numbers import POLISHING, STEP_FINELY, is_rough, likeliest_size, polished
from tests.diagnosis.arm import LONG_S, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

# Truth: a driver whose steps are a third of a volt, of which the commands meet five.
STEP_V, LEVEL = 0.33, 5.0
NAME = "input.quantization"


def stepping(**shape: float) -> tuple[Case, Hypothesis]:
    """A run of the arm behind such a driver, and the hypothesis that is right, fitted."""
    truth = {"q": STEP_V, "h": 0.0, "s": 0.0, **shape}
    case = arm_case(arm_log({NAME: truth}, seconds=LONG_S))
    found = fit(case, nominal_fit(case).hypothesis.with_effects({NAME: truth}))
    assert found is not None
    return case, found.hypothesis


def test_multiples_are_found_where_steps_that_lie_beside_theirs_do_nearly_the_same() -> None:
    # Steps 1 % larger that lie 5 % of one beside their multiples lie the same at the fifth.
    case, right = stepping()
    beside = right.with_effects({NAME: {"q": 1.01 * STEP_V, "h": 0.0, "s": 0.01 * LEVEL}})
    found = polished(case, beside, NAME, STEP_FINELY).effects[NAME]
    assert found["s"] == 0.0
    assert found["q"] == pytest.approx(STEP_V, rel=1e-3)


def test_steps_follow_by_how_much_they_are_held() -> None:
    # Truth: held 0.13 of a step beyond its half. Steps 0.4 % smaller that are held so much longer leave the level above the mean at the
    # same command: from there neither number alone is likelier, and both together are.
    case, right = stepping(h=0.13)
    step = 0.996 * STEP_V
    held = (LEVEL + 0.63) * STEP_V / step - LEVEL - 0.5
    start = right.with_effects({NAME: {"q": step, "h": held, "s": 0.0}})
    found = polished(case, start, NAME, STEP_FINELY)
    assert likelihood_of(case, found) > likelihood_of(case, right) - 3.0
    assert found.effects[NAME]["q"] == pytest.approx(STEP_V, rel=2e-3)
    assert found.effects[NAME]["h"] == pytest.approx(0.13, abs=0.01)


def test_a_size_is_taken_from_the_factors_tried_and_only_where_slopes_lead_nowhere() -> None:
    case, right = stepping()
    assert is_rough(case, NAME)
    assert not is_rough(case, "arm.coulomb")
    start = right.with_effects({NAME: {**right.effects[NAME], "q": STEP_V / (1.0 - POLISHING[0])}})
    found = likeliest_size(case, start, NAME, np.array([1.0, 1.0 - POLISHING[0]]))
    assert found.effects[NAME]["q"] == pytest.approx(STEP_V)


def test_a_step_is_known_no_better_than_where_its_steps_lie() -> None:
    # Truth: (L - s) q, at the level L = 5 next to the mean command, is what the logs show: of steps that lie beside their multiples by what
    # is known to a share of one, q is known to a fifth of that share; of those at their multiples as the slopes say.
    case, right = stepping()
    beside = right.with_effects({NAME: {"q": STEP_V, "h": 0.0, "s": 0.05}})
    shown = [estimates(case, as_fitted(case, found))[NAME] for found in (_fit(case, right), _fit(case, beside))]
    assert shown[0]["q"].sd < 1e-3 * STEP_V
    assert shown[1]["q"].sd == pytest.approx(STEP_V * shown[1]["s"].sd / LEVEL, rel=0.05)


def _fit(case: Case, at: Hypothesis) -> Fit:
    found = fit(case, at, rounds=0)
    assert found is not None
    return found
