"""The likelihood of some hypotheses."""

from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.profile_likelihood import known_to, likeliest, likelihoods
from sim.effect import Role
from tests.diagnosis.arm import arm_case, arm_log, plain_linearisation
from tests.diagnosis.nominal import nominal_fit


def test_the_likeliest_of_some_hypotheses_has_the_filters_own_likelihood() -> None:
    linearisation = plain_linearisation()
    case, fitted = linearisation.case, linearisation.fit.hypothesis
    worse = fitted.with_effects({"theta_sensor.delay": {"tau": 0.1, "jitter": 0.0}})
    best, value = likeliest(case, [worse, fitted])
    assert best is fitted
    assert value == likelihood_of(case, fitted) == likelihoods(case, [fitted])[0]


def test_where_steps_lie_is_known_where_they_show_and_not_where_none_are_met() -> None:
    # Truth: steps of 0.2 V that lie 0.3 of one below the multiples, of which a thirtieth of a step more or less is seen; of steps of a
    # hundredth of that hardly anything is.
    told = []
    for step in (0.2, 0.002):
        values = {"q": step, "h": 0.0, "s": 0.3}
        case = arm_case(arm_log({"input.quantization": values}))
        found = fit(case, nominal_fit(case).hypothesis.with_effects({"input.quantization": values}))
        assert found is not None
        shift = case.library.effects["input.quantization"].having(Role.SHIFT)
        assert shift is not None
        told.append(known_to(case, found.hypothesis, "input.quantization", shift))
    assert told[0] <= 0.03
    assert told[1] >= 0.1
