"""Single effects under the noise with a memory that the likeliest of them leaves."""

from dataclasses import replace

import pytest

from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import Case
from diagnosis.search.singles import Alone, alone, best_of, first_fits, under_noise
from tests.diagnosis.arm import arm_case, arm_log

# Truth: 60 mrad of play in the encoder's coupling, in wind of 0.5 mN m that comes and goes within 0.3 s.
TRUTH = {"theta_sensor.backlash": {"width": 0.06}, "arm.gust": {"sigma": 5e-4, "T": 0.3}}
RIGHT = frozenset(("theta_sensor.backlash",))


@pytest.fixture(scope="module")
def case() -> Case:
    return arm_case(arm_log(TRUTH, seed=71, seconds=20.0))


@pytest.fixture(scope="module")
def usual(case: Case) -> Alone:
    """Names as white noise alone has them."""
    nominal = as_fitted(case, plain_fit(case))
    linearisation = linearised(case, nominal.fit)
    score_tests = score_effects(case, linearisation, case.library.candidates)
    return alone(case, first_fits(case, nominal, linearisation, score_tests))


def test_nothing_is_added_where_the_same_leads_under_either_noise(case: Case, usual: Alone) -> None:
    assert frozenset(best_of(usual.found).effects) == RIGHT
    assert under_noise(case, usual) == {}


def test_a_name_that_leads_under_white_noise_alone_gives_way(case: Case, usual: Alone) -> None:
    astray = replace(usual, found={names: entry for names, entry in usual.found.items() if names != RIGHT})
    found = under_noise(case, astray)
    assert frozenset(best_of(found).effects) == RIGHT
    assert best_of(found).fit.hypothesis.effects["theta_sensor.backlash"]["width"] == pytest.approx(0.06, rel=0.2)
