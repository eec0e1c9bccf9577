"""Truth: potentials by hand, functions of two regimes, a motion whose accelerations are known."""

from dataclasses import replace

import numpy as np
import pytest

from identification.envelope.criteria import Match, matches, passed, score_percent
from identification.envelope.flights.flight import Deviations, GRAVITY_m_s2
from identification.envelope.output_equation.clusters import Radii, subtractive
from identification.envelope.output_equation.fuzzy import fuzzy, gradient
from identification.envelope.output_equation.outputs import SLOPE_ROWS, classical, linear


def test_potentials_by_hand():
    """Points 0, 1/4, 1 of unit range, r_a = 1/2: alpha = 16; squared distances 1/16, 1, 9/16."""
    found = subtractive(np.array([[0.0], [0.25], [1.0]]), Radii(radius=0.5, squash=1.25))
    first = 1.0 + np.exp(-1.0) + np.exp(-9.0)  # of the point 1/4
    third = 1.0 + np.exp(-16.0) + np.exp(-9.0)
    beta = 4.0 / (1.25 * 0.5) ** 2
    assert found.chosen == (1, 2)
    assert found.potentials == pytest.approx((first, third - first * np.exp(-beta * 9.0 / 16.0)), rel=1e-14)


def test_three_heaps_give_three_centres_in_them():
    rng = np.random.default_rng(0)
    heaps = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]])
    points = np.concatenate([heap + 0.03 * rng.standard_normal((50, 2)) for heap in heaps])
    chosen = subtractive(points, Radii(radius=0.4)).chosen
    assert sorted(place // 50 for place in chosen) == [0, 1, 2]


def test_rules_that_are_linear_reproduce_a_linear_function():
    rng = np.random.default_rng(1)
    z, C = rng.standard_normal((300, 3)), np.array([[2.0, 3.0], [-5.0, 7.0], [11.0, -13.0]])
    found = fuzzy(z, z @ C + [17.0, 19.0], np.array([1.0, 10.0]), epochs=2, radii=Radii(0.5))
    assert len(found.system.centre) > 1
    assert found.system(z) == pytest.approx(z @ C + [17.0, 19.0], abs=0.05)  # of a range of 80: the ridge


def test_training_bends_where_a_straight_line_cannot():
    z = np.linspace(-1.0, 1.0, 200)[:, None]
    y = np.abs(z)
    straight = np.sqrt(np.mean((y - y.mean()) ** 2))
    found = fuzzy(z, y, np.ones(1), epochs=30, radii=Radii(0.5))
    assert found.error[0] < 0.4 * straight
    assert min(found.error) < 0.9 * found.error[0]
    assert np.sqrt(np.mean((found.system(z) - y) ** 2)) == pytest.approx(min(found.error), rel=1e-9)


def test_the_gradient_is_that_of_differences():
    rng = np.random.default_rng(2)
    z, y = rng.uniform(0, 1, (60, 2)), rng.standard_normal((60, 2))
    system = fuzzy(z, y, np.ones(2), epochs=0, radii=Radii(0.5)).system
    system = replace(system, lowest=np.zeros(2), span=np.ones(2))

    def half_mean_square(entry):
        return np.mean((entry(z) - y) ** 2) / 2

    for field, slope in zip(("centre", "sigma"), gradient(system, z, y), strict=True):
        for place in np.ndindex(slope.shape):
            ways = []
            for sign in (1.0, -1.0):
                value = getattr(system, field).copy()
                value[place] += sign * 1e-6
                ways.append(half_mean_square(replace(system, **{field: value})))
            assert slope[place] == pytest.approx((ways[0] - ways[1]) / 2e-6, rel=1e-4, abs=1e-9)


def motion():
    """Velocities that are parabolas of time, steady rates, attitude straight in time: a derivative by parabolas is exact."""
    t_s = 0.05 * np.arange(100)
    one = np.ones_like(t_s)
    x = np.stack([30 + 2 * t_s, 1 - t_s**2, 3 * t_s, 0.1 * one, 0.2 * one, -0.3 * one, 0.05 * t_s, -0.02 * t_s], axis=1)
    return t_s, x


def test_classical_equations_of_a_known_motion():
    t_s, x = motion()
    u, v, w, p, q, r, phi, theta = x.T
    g = GRAVITY_m_s2
    truth = np.stack(
        [
            2.0 + q * w - r * v + g * np.sin(theta),
            -2.0 * t_s + r * u - p * w - g * np.cos(theta) * np.sin(phi),
            3.0 + p * v - q * u - g * np.cos(theta) * np.cos(phi),
        ],
        axis=1,
    )
    trim = np.array([25.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.02, 0.01])
    at_rest = np.array([g * np.sin(0.01), -g * np.cos(0.01) * np.sin(0.02), -g * np.cos(0.01) * np.cos(0.02)])
    whole = np.concatenate([np.zeros(4), trim, np.zeros(3)])[None]
    data = Deviations(0.05, np.zeros((1, 100, 4)), (x - trim)[None], truth[None], whole, ("",))
    inner = slice(SLOPE_ROWS // 2, -(SLOPE_ROWS // 2))  # the parabola needs rows on both sides
    assert classical(data, data.x)[0, inner] == pytest.approx((truth - at_rest)[inner], abs=1e-9)


def test_a_linear_output_equation_comes_back():
    rng = np.random.default_rng(4)
    x, u = rng.standard_normal((2, 50, 8)), rng.standard_normal((2, 50, 4))
    C, D = rng.standard_normal((3, 8)), rng.standard_normal((3, 4))
    data = Deviations(0.05, u, x, x @ C.T + u @ D.T, np.zeros((2, 15)), ("", ""))
    found = linear(data)
    assert pytest.approx(C, abs=1e-12) == found.C
    assert pytest.approx(D, abs=1e-12) == found.D
    assert found(data, x) == pytest.approx(data.y, abs=1e-12)


def test_the_score_weighs_by_hand():
    """10 % outside, 1.5 of 3 s held, fit 80 %, correlation -0.5: (4 * 90 + 3 * 50 + 2 * 80 + 1 * 0) / 10."""
    poor = Match("a", 10.0, 1.5, 80.0, -0.5, 0.3)
    assert score_percent([poor]) == pytest.approx(67.0)
    assert score_percent([Match("a", 0.0, 24.0, 100.0, 1.0, 0.0)]) == pytest.approx(100.0)
    assert not passed([poor])


def test_the_rule_holds_for_each_flight_by_itself():
    measured = np.zeros((2, 100, 1))
    estimated = measured.copy()
    estimated[1, 20:] = 2.0
    (found,) = matches(("a",), measured, estimated, np.ones(1), 0.1)
    assert found.held_s == pytest.approx(2.0)
    assert found.outside_percent == pytest.approx(40.0)
    assert found.error_margins == pytest.approx(np.sqrt(0.4 * 4.0))


def test_theils_fit_rewards_noise_and_the_error_does_not():
    """Noise of unit size: beside it an estimate of other unit noise fits by 1 - 1 / sqrt(2), zero by 0; their errors are sqrt(2) and 1."""
    noise, other = np.random.default_rng(5).standard_normal((2, 1, 20000, 1))
    (moving,) = matches(("a",), noise, other, np.ones(1), 0.1)
    (still,) = matches(("a",), noise, np.zeros_like(noise), np.ones(1), 0.1)
    assert (moving.fit_percent, still.fit_percent) == (pytest.approx(100 * (1 - np.sqrt(0.5)), abs=1.0), 0.0)
    assert (moving.error_margins, still.error_margins) == (
        pytest.approx(np.sqrt(2), rel=0.02),
        pytest.approx(1, rel=0.02),
    )
