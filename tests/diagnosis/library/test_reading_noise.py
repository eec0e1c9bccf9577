"""Errors of readings as states of the equations: felt while their switch is 1, asleep else."""

import sympy

from diagnosis.library.reading_noise import ReadingNoise, state_of, switch_of, time_of, with_reading_noise
from sim.model import symbol
from tests.diagnosis.arm import arm


def test_an_error_joins_its_output_and_fades_with_its_time() -> None:
    model = with_reading_noise(arm().model)
    error = symbol(state_of("theta_rad"))
    on, T = (sympy.Symbol(name("theta_rad"), real=True) for name in (switch_of, time_of))
    assert model.outputs["theta_rad"] - arm().model.outputs["theta_rad"] == on * error
    assert sympy.simplify(model.rates[error] + on * error / T) == 0
    assert model.sleepers[error] == on


def test_its_intensity_keeps_its_variance() -> None:
    # Truth: q T / 2 = s^2 in the steady state.
    noise = ReadingNoise(3e-3, 0.2)
    assert abs(noise.intensity * noise.time_s / 2.0 - 9e-6) < 1e-18
