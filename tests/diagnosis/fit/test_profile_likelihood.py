"""The likelihood of some hypotheses."""

from diagnosis.fit.gauss_newton import likelihood_of
from diagnosis.fit.profile_likelihood import likeliest, likelihoods
from tests.diagnosis.arm import plain_linearisation


def test_the_likeliest_of_some_hypotheses_has_the_filters_own_likelihood() -> None:
    linearisation = plain_linearisation()
    case, fitted = linearisation.case, linearisation.fit.hypothesis
    worse = fitted.with_effects({"theta_sensor.delay": {"tau": 0.1, "jitter": 0.0}})
    best, value = likeliest(case, [worse, fitted])
    assert best is fitted
    assert value == likelihood_of(case, fitted) == likelihoods(case, [fitted])[0]
