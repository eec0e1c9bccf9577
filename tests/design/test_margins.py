"""Margins: the published table for every pole set, and loops whose margins are known otherwise."""

from dataclasses import replace

import numpy as np
import pytest

from design.analysis.margins import margins
from design.loop import closed_loop_poles, open_loop, slowest
from design.schedule import evaluate, schedule_of
from tests.design.helicopter import AZ_DOM, DOM, DOM2, equal, polynomials, settings_for, table_for, wide_angles


def loops(axis, poles, free_degree, angles):
    table = table_for(settings_for(**{axis: (poles, free_degree)}))
    schedule = schedule_of(table.axis(axis))
    return [open_loop(polynomials(axis, psi), evaluate(schedule, psi)) for psi in angles]


# Stated digits: sensitivity +-0.006, phase +-0.6 deg, gain up +-1.5 %, gain down +-0.02, delay +-1 ms; worst over +-42 deg.
TABLE = [
    ("elevation", equal(-4.0), "q3_zero", 4.85, 13, None, None, None),
    ("elevation", equal(-6.0), "q3_zero", 2.50, 24, 2.17, None, None),
    ("elevation", equal(-8.0), "q3_zero", 2.12, 31, 2.45, None, 136.0),
    ("elevation", equal(-12.0), "q3_zero", 2.00, 35, 2.57, None, 88.0),
    ("elevation", equal(-16.0), "q3_zero", 2.03, 34, 2.51, None, None),
    ("elevation", equal(-4.0), "integral", 2.74, 21, 2.67, 0.60, None),
    ("elevation", equal(-8.0), "integral", 2.10, 29, 3.17, 0.35, None),
    ("elevation", equal(-12.0), "integral", 2.13, 29, 2.95, 0.32, 40.0),
    ("elevation", DOM2, "integral", 1.73, 37, 4.09, 0.29, 79.0),
    ("elevation", DOM, "integral", 1.78, 35, 4.08, 0.38, None),
    ("azimuth", equal(-4.0), "q3_zero", 1.43, 66, 4.41, None, None),
    ("azimuth", AZ_DOM, "q3_zero", 1.36, 67, 5.9, None, None),
]


@pytest.mark.parametrize(("axis", "poles", "free", "sensitivity", "phase_deg", "up", "down", "delay_ms"), TABLE)
def test_worst_margins_over_the_range_are_the_published_ones(
    axis, poles, free, sensitivity, phase_deg, up, down, delay_ms
):
    found = [margins(loop) for loop in loops(axis, poles, free, wide_angles())]
    assert max(m.sensitivity for m in found) == pytest.approx(sensitivity, abs=6e-3)
    assert np.degrees(min(m.phase_rad for m in found)) == pytest.approx(phase_deg, abs=0.6)
    if up is not None:
        assert min(m.gain_up for m in found) == pytest.approx(up, rel=1.5e-2)
    if down is not None:
        assert max(m.gain_down for m in found) == pytest.approx(down, abs=0.02)
    if delay_ms is not None:
        assert 1e3 * min(m.delay_s for m in found) == pytest.approx(delay_ms, abs=1.5)


@pytest.mark.parametrize(("poles", "free"), [(equal(-4.0), "q3_zero"), (equal(-8.0), "integral"), (DOM2, "integral")])
@pytest.mark.parametrize("psi_deg", [-35.0, 0.0, 38.0])
def test_gain_margins_are_where_the_closed_loop_poles_cross(poles, free, psi_deg):
    (loop,) = loops("elevation", poles, free, [np.radians(psi_deg)])
    found = margins(loop)

    def stable(gain):
        return slowest(closed_loop_poles(replace(loop, q=loop.q * gain))) < 1e-6

    assert stable(1.0)
    assert stable(found.gain_up * 0.999)
    assert not stable(found.gain_up * 1.005)
    if found.gain_down > 0.0:
        assert stable(found.gain_down * 1.005)
        assert not stable(found.gain_down * 0.995)


def test_delay_margin_is_where_whole_samples_of_delay_destabilise():
    (loop,) = loops("elevation", DOM2, "integral", [0.0])
    samples = margins(loop).delay_s / loop.sample_period_s

    def late(count):
        # z^-1 = 1/(1 + gamma): each sample of delay multiplies the denominator of the loop by 1 + gamma.
        p = loop.p
        for _ in range(count):
            p = np.convolve(p, [1.0, 1.0])
        closed = np.convolve(loop.a, p)
        driven = np.convolve(loop.b, loop.q)
        closed[: len(driven)] += driven
        return np.max(np.abs(1.0 + np.roots(closed[::-1])))

    assert late(int(np.floor(samples))) < 1.0
    assert late(int(np.ceil(samples))) > 1.0


def test_an_integrating_loop_has_the_textbook_margins():
    # L = K gamma^-1, a sampled integrator: gain margin 2/K, phase margin pi/2 - omega Ts/2 with 2 sin(omega Ts/2) = K.
    loop = replace(
        open_loop(polynomials("azimuth", 0.0), evaluate(schedule_of(table_for(settings_for()).axes[1]), 0.0)),
        b=np.array([0.5, 0.0, 0.0, 0.0]),
        a=np.array([0.0, 1.0, 0.0, 0.0]),
        q=np.array([1.0, 0.0, 0.0, 0.0]),
        p=np.array([1.0, 0.0, 0.0, 0.0]),
    )
    found, crossover = margins(loop), 2.0 * np.arcsin(0.25)
    assert found.gain_up == pytest.approx(4.0, rel=1e-9)
    assert found.gain_down == 0.0
    assert found.crossover_rad_s == pytest.approx(crossover / loop.sample_period_s, rel=1e-5)
    assert found.phase_rad == pytest.approx(np.pi / 2.0 - crossover / 2.0, rel=1e-5)
