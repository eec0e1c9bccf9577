"""Dry friction and hard stops against motions that can be written down."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import sympy

from sim.bind import BoundPlant
from sim.model import TIME, ParameterSpec, symbol
from sim.simulate import Conditions, simulate
from tests.sim.conftest import POSITION, VELOCITY

EXACT = 1e-12  # motions that are cubic in time are exact for RK4 but for rounding
FORCES = ("spring", "damping", "wave", "rate", "ramp", "push")


@pytest.fixture(scope="module")
def driven(mechanism) -> Callable[..., BoundPlant]:
    """driven(values, spring=..., ...): the mechanism, driven by -spring s - damping v + wave sin(rate t) + ramp t + push.

    One kernel serves all.
    """
    spring, damping, wave, rate, ramp, push = (symbol(name) for name in FORCES)
    force = -spring * POSITION - damping * VELOCITY + wave * sympy.sin(rate * TIME) + ramp * TIME + push
    base = mechanism(force)
    parameters = (*base.model.parameters, *(ParameterSpec(name, 1, "1") for name in FORCES))
    model = replace(base.model, parameters=parameters)

    def build(values: tuple[float, float, float] = (2.0, 0.5, 10.0), **given: float) -> BoundPlant:
        p = np.array([*values, *(given.pop(name, 0.0) for name in FORCES)])
        assert not given
        return BoundPlant(base.plant, model, p, np.zeros(len(p)))

    return build


def run(bound, x0, u=0.0, seconds=3.0, period=0.01, **options):
    t = np.arange(round(seconds / period) + 1) * period
    u = np.broadcast_to(np.asarray(u, float).reshape(-1, 1), (t.size, 1)).copy()
    return t, simulate(bound, t, x0, u, Conditions(resolution=[0.0], **options)).x


def test_a_sliding_body_stops_where_and_when_friction_says_and_stays(driven):
    m, c, v0 = 2.0, 0.5, 1.2345
    t, x = run(driven(), [0.3, v0], seconds=8.0)
    stop_s = m * v0 / c
    moving = np.minimum(t, stop_s)
    np.testing.assert_allclose(x[:, 0], 0.3 + v0 * moving - c / m * moving**2 / 2, atol=EXACT)
    assert np.all(x[t > stop_s, 1] == 0.0)


def test_a_growing_force_breaks_the_body_away_at_the_right_time(driven):
    m, c, rate = 2.0, 0.5, 0.3
    t, x = run(driven(ramp=rate), [0.0, 0.0], seconds=4.0)
    since = np.maximum(t - c / rate, 0.0)
    np.testing.assert_allclose(x[:, 0], rate / m * since**3 / 6, atol=EXACT)
    assert np.all(x[t < c / rate] == 0.0)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_friction_turns_with_the_motion_without_sticking(driven, direction):
    """Thrown up a slope whose pull exceeds friction: slower on the way back, in closed form."""
    m, c, pull, v0 = 2.0, 0.5, 3.0, 1.1
    t, x = run(driven(), [0.0, direction * v0], u=-direction * pull, seconds=1.5)
    turn_s = m * v0 / (pull + c)
    top = m * v0**2 / (pull + c) / 2
    up = v0 * t - (pull + c) / m * t**2 / 2
    down = top - (pull - c) / m * (t - turn_s) ** 2 / 2
    np.testing.assert_allclose(direction * x[:, 0], np.where(t < turn_s, up, down), atol=EXACT)


def test_a_spring_loses_a_fixed_amplitude_each_half_swing_and_sticks(driven):
    """m s'' = -k s - c sgn(s'): each half swing takes 2 c/k from the amplitude; it sticks where |k s| <= c."""
    m, c, k, amplitude = 2.0, 0.5, 40.0, 0.2
    t, x = run(driven(spring=k), [amplitude, 0.0], seconds=6.0)
    turns = [amplitude]
    while abs(turns[-1]) > c / k:
        turns.append(-np.sign(turns[-1]) * (abs(turns[-1]) - 2 * c / k))
    half_s = np.pi / np.sqrt(k / m)
    rest_s = half_s * (len(turns) - 1)
    tolerance = 2e-8  # of RK4 with 10 ms at 4.5 rad/s over 6 s
    assert np.all(x[t > rest_s + 0.01, 1] == 0.0)
    np.testing.assert_allclose(x[-1, 0], turns[-1], atol=tolerance)
    within = t < half_s
    np.testing.assert_allclose(
        x[within, 0], c / k + (amplitude - c / k) * np.cos(np.sqrt(k / m) * t[within]), atol=tolerance
    )


def test_the_order_through_stops_and_reversals_is_four(driven):
    """Without a located event the error of a reversal would fall as h^2: here 16 times smaller for half the step."""
    bound = driven((2.0, 0.5, 0.15), spring=40.0, damping=0.3, wave=3.0, rate=7.0)
    fine = run(bound, [0.1, 0.0], seconds=5.0, substeps=100)[1]
    errors = [np.abs(run(bound, [0.1, 0.0], seconds=5.0, substeps=n)[1] - fine)[:, 0].max() for n in (1, 2, 4)]
    assert errors[0] < 1e-6
    assert errors[0] / errors[1] > 10.0
    assert errors[1] / errors[2] > 10.0


def test_a_stop_holds_without_rebound_until_the_force_turns(driven):
    m, c, limit, force = 2.0, 0.5, 0.4, 1.5
    t = np.arange(301) * 0.01
    u = np.where(t < 1.995, force, -force)
    _, x = run(driven((m, c, limit)), [0.0, 0.0], u=u, seconds=3.0)
    hit_s = np.sqrt(2 * limit * m / (force - c))
    assert np.all(x[(t > hit_s) & (t < 1.995)] == [limit, 0.0])
    back = np.maximum(t - 2.0, 0.0)
    after = t >= 2.0
    np.testing.assert_allclose(x[after, 0], limit - (force - c) / m * back[after] ** 2 / 2, atol=EXACT)
    before = t < hit_s
    np.testing.assert_allclose(x[before, 0], (force - c) / m * t[before] ** 2 / 2, atol=EXACT)


def test_friction_holds_the_body_at_a_stop_against_a_small_pull(driven):
    _, x = run(driven((2.0, 0.5, 0.4)), [-0.4, 0.0], u=0.49)
    assert np.all(x == [-0.4, 0.0])


def test_a_start_beyond_a_stop_is_put_onto_it(driven):
    _, x = run(driven((2.0, 0.5, 0.4)), [0.6, 1.0], u=1.0)
    assert np.all(x[1:] == [0.4, 0.0])


def test_a_velocity_that_touches_zero_within_one_step_is_noticed(driven):
    """Driven by m a (t - 5 ms) + c, v = (t - 5 ms)^2 a/2 - w would dip below zero and return before the step ends: it sticks on the way."""
    m, c, a, w = 2.0, 0.5, 40.0, 1e-5
    bound = driven(ramp=m * a, push=c - m * a * 0.005)
    x0 = [0.0, a * 0.005**2 / 2 - w]
    x = run(bound, x0, seconds=0.01)[1]
    fine = run(bound, x0, seconds=0.01, substeps=1000)[1]
    smooth = a * 0.005**2 / 2 - w
    assert abs(x[-1, 1] - smooth) > 1e-6
    np.testing.assert_allclose(x[-1], fine[-1], atol=1e-9)


def test_without_friction_and_stops_in_reach_energy_stays(driven):
    k, m = 40.0, 2.0
    _, x = run(driven((m, 0.0, 10.0), spring=k), [0.2, 0.0], seconds=10.0)
    energy = k * x[:, 0] ** 2 / 2 + m * x[:, 1] ** 2 / 2
    assert abs(energy[-1] / energy[0] - 1) < 1e-5  # RK4 damps by (omega h)^6 / 72 per step, 1e-10 here
    assert np.all(np.diff(energy) < 1e-15)


def test_a_locked_axis_stays(driven):
    _, x = run(driven(), [0.1, 0.0], u=50.0, locked=("slide",))
    assert np.all(x == [0.1, 0.0])


def test_many_events_in_one_step_end_in_a_held_body_not_in_a_hang(driven):
    bound: BoundPlant = driven(wave=5.0, rate=30000.0)
    _, x = run(bound, [0.0, 0.0], seconds=0.05)
    assert np.all(np.isfinite(x))


def test_batched_and_single_runs_are_the_same_bits(driven):
    bound = driven((2.0, 0.5, 0.1), spring=40.0, wave=3.0, rate=7.0)
    random = np.random.default_rng(1)
    x0 = random.uniform(-0.1, 0.1, (19, 2))
    p = bound.p * random.uniform(0.8, 1.2, (19, len(bound.p)))
    one = [run(bound, start, p=own)[1] for start, own in zip(x0, p, strict=True)]
    assert np.array_equal(one, run(bound, x0, p=p)[1])
