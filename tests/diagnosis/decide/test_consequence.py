"""A gap matters by what its explanation predicts, not by how certain many rows make it."""

from diagnosis.decide.consequence import consequence
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.nominal import nominal_fit
from diagnosis.hypothesis.case import Case
from tests.diagnosis.arm import arm_case, arm_log


def explained(case: Case, plain: FittedHypothesis, effect: str, values: dict[str, float]) -> FittedHypothesis:
    found = fit(case, plain.fit.hypothesis.with_effects({effect: values}))
    assert found is not None
    return as_fitted(case, found)


def test_friction_that_holds_the_arm_matters_and_a_lag_of_a_millisecond_does_not() -> None:
    # Truth: 0.4 mN m of dry friction, which moves a prediction by many counts; the arm reads 1 ms late, a fifth of a count in usual motion.
    gains = []
    for effect, values in (("arm.coulomb", {"b": 4e-4}), ("theta_sensor.delay", {"tau": 1e-3, "jitter": 0.0})):
        case = arm_case(arm_log({effect: values}, seed=76))
        plain = as_fitted(case, nominal_fit(case))
        (rule,) = consequence(case, plain, [explained(case, plain, effect, values)])
        gains.append(rule.value)
        assert rule.of == effect
    assert gains[0] is not None
    assert gains[1] is not None
    assert gains[0] > 0.3
    assert gains[1] < 0.05


def test_what_was_not_tried_is_not_asked() -> None:
    case = arm_case(arm_log(seed=76))
    assert consequence(case, as_fitted(case, nominal_fit(case)), []) == ()
