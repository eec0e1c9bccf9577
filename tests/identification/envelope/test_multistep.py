"""Truth: steps counted by hand, the discrete Fourier transform, Parseval's theorem."""

import numpy as np
import pytest

from identification.envelope.flights.multistep import (
    DOUBLET,
    PULSE,
    STEPS_2311,
    STEPS_3211,
    band_Hz,
    multistep,
    spectrum,
)


def test_a_2311_is_two_up_three_down_one_up_one_down():
    t_s = np.arange(10) + 0.5
    assert multistep(t_s, STEPS_2311, 1.0, start_s=1.0).tolist() == [0, 1, 1, -1, -1, -1, 1, -1, 0, 0]
    assert multistep(t_s, STEPS_3211, 1.0, start_s=1.0).tolist() == [0, 1, 1, 1, -1, -1, 1, -1, 0, 0]


def test_a_ramp_is_straight_and_centred_on_its_edge():
    t_s = np.array([1.8, 1.9, 2.0, 2.05, 2.1, 2.2])
    found = multistep(t_s, (2, 3), 1.0, ramp_s=0.2)
    assert found == pytest.approx([1.0, 1.0, 0.0, -0.5, -1.0, -1.0])


@pytest.mark.parametrize("steps", [STEPS_2311, STEPS_3211, DOUBLET, PULSE])
def test_the_spectrum_is_that_of_the_signal(steps):
    step_s, unit_s = 0.001, 0.7
    t_s = step_s * (np.arange(20000) + 0.5)
    f = np.fft.rfftfreq(20000, step_s)[:200]
    found = np.abs(np.fft.rfft(multistep(t_s, steps, unit_s))[:200] * step_s) ** 2
    # A sum of rectangles differs from the integral by (pi f dt)^2 / 3 relatively, 3e-4 at 10 Hz, and by the edges' sampling.
    assert np.abs(spectrum(f, steps, unit_s) - found).max() < 1e-3 * found.max()


def test_both_are_asymmetric_and_a_doublet_is_not():
    zero = np.zeros(1)
    assert spectrum(zero, STEPS_3211, 0.5)[0] == pytest.approx((0.5 * (3 - 2 + 1 - 1)) ** 2)
    assert spectrum(zero, STEPS_2311, 0.5)[0] == pytest.approx((0.5 * (2 - 3 + 1 - 1)) ** 2)
    assert spectrum(zero, DOUBLET, 0.5)[0] == pytest.approx(0.0, abs=1e-20)


def test_the_spectrum_holds_the_signals_energy():
    # Parseval: 2 int_0^F |U|^2 df = 7 units, less a tail of about (sum of squared jumps = 14) / (2 pi^2 F).
    f = np.linspace(0.0, 50.0, 200001)
    energy = 2 * np.trapezoid(spectrum(f, STEPS_3211, 1.0), f)
    assert energy == pytest.approx(7.0 - 14 / (2 * np.pi**2 * 50.0), rel=2e-3)


def test_multisteps_are_broader_than_a_doublet():
    def width(steps):
        low, high = band_Hz(steps, 1.0, share=0.2)
        return high / max(low, 1e-3)

    assert width(STEPS_3211) > 1.5 * width(DOUBLET)
    assert width(STEPS_2311) > 1.5 * width(DOUBLET)
