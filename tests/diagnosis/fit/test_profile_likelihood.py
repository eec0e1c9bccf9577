"""Line searches in the likelihood, on curves whose tops are known."""

from collections.abc import Callable

import pytest

from diagnosis.fit.gauss_newton import likelihood_of
from diagnosis.fit.profile_likelihood import Point, by_parabola, likeliest, likelihoods
from tests.diagnosis.arm import plain_linearisation


def along(curve: Callable[[float], float]) -> Callable[[float], Point]:
    return lambda x: Point(x, plain_linearisation().fit.hypothesis, curve(x))


@pytest.mark.parametrize("start", [-3.0, 0.0, 0.7, 4.0])
def test_the_top_of_a_parabola_is_found_exactly_from_either_side(start: float) -> None:
    at = along(lambda x: 5.0 - 2.0 * (x - 0.73) ** 2)
    found = by_parabola(at, at(start), 0.3, 20, 1e-6)
    assert found.x == pytest.approx(0.73, abs=1e-9)
    assert found.value == pytest.approx(5.0)


def test_a_top_that_promises_next_to_nothing_is_not_asked_for() -> None:
    asked: list[float] = []

    def at(x: float) -> Point:
        asked.append(x)
        return along(lambda x: -0.001 * x**2)(x)

    assert by_parabola(at, at(0.01), 0.3, 20, 0.1).x == 0.01
    assert len(asked) == 3


def test_the_likeliest_of_some_hypotheses_has_the_filters_own_likelihood() -> None:
    linearisation = plain_linearisation()
    case, fitted = linearisation.case, linearisation.fit.hypothesis
    worse = fitted.with_effects({"theta_sensor.delay": {"tau": 0.1, "jitter": 0.0}})
    best, value = likeliest(case, [worse, fitted])
    assert best is fitted
    assert value == likelihood_of(case, fitted) == likelihoods(case, [fitted])[0]
