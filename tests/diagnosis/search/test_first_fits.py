"""Single effects as they begin, and as they end."""

from diagnosis import decisions
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.evidence import as_fitted
from diagnosis.search.exchange import twins_of
from diagnosis.search.singles import alone, first_fits
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


def test_what_looks_like_one_cause_takes_no_place_of_another() -> None:
    # Truth: an angle that is read 50 mrad too large, which five effects explain alike to first order.
    case = arm_case(arm_log({"theta_sensor.offset": {"offset": 0.05}}, seed=71))
    nominal = as_fitted(case, nominal_fit(case))
    linearisation = linearised(case, nominal.fit)
    tests = score_effects(case, linearisation, case.library.candidates)
    begun = {entry.effects[0] for entry in first_fits(case, nominal, linearisation, tests).begun}
    assert begun > {entry.effect for entry in tests[: decisions.SINGLES]}
    kinds: set[str] = set()
    for name in (entry.effect for entry in tests if entry.effect in begun):
        kinds |= set() if twins_of(case.library, name) & kinds else {name}
    assert len(kinds) == decisions.SINGLES
