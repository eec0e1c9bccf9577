"""Single effects as they begin, and as they end."""

from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.evidence import as_fitted
from diagnosis.search.beam import alone, first_fits
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

NAMES = ["arm.coulomb", "arm.quadratic_drag", "input.deadzone"]


def test_none_ends_less_likely_than_it_began_and_the_true_one_leads_from_the_beginning() -> None:
    # Truth: 0.4 mN m of dry friction on an arm that has none.
    case = arm_case(arm_log({"arm.coulomb": {"b": 4e-4}}, seed=71))
    nominal = as_fitted(case, nominal_fit(case))
    linearisation = linearised(case, nominal.fit)
    first = first_fits(case, nominal, linearisation, score_effects(case, linearisation, NAMES))
    assert first.best.effects == ("arm.coulomb",)
    ended = alone(case, first).found
    for entry in first.begun:
        assert ended[frozenset(entry.effects)].evidence >= entry.evidence
    assert len(first.begun) > 1
