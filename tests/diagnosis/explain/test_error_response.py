"""Frequency bands of a gap: coherence, bands that it supports, and by how much the rig's answers differ."""

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.explain.error_response import error_responses
from diagnosis.explain.maps import band_map
from diagnosis.explain.spectra import averages, coherence
from diagnosis.fit.gauss_newton import unfitted
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from sim.bind import BoundPlant
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit
from tests.soak import SOAK, sampled

ROWS, STEP_S = 6000, 0.01
SEEDS = (71, 72) if SOAK else (71,)
T_S = STEP_S * np.arange(ROWS)
Late = Callable[[str, float], Linearisation]


@pytest.fixture(scope="module")
def late(plant: BoundPlant, fly: Fly) -> Late:
    """Flights of a rig that is as stated but for a delay of so many seconds, under the plant as stated; once for each."""

    @cache
    def flown(effect: str, tau_s: float) -> Linearisation:
        as_stated = dict.fromkeys((str(symbol) for symbol in plant.model.parameter_symbols), 1.0)
        logs = [fly(seed, {effect: {"tau": tau_s}}, factors=as_stated, jumps_rad=0.05, air=False) for seed in SEEDS]
        case = make_case(effect_library(plant), logs)
        stated = unfitted(case, nominal_fit(case).hypothesis)
        assert stated is not None
        return linearised(case, stated)

    return flown


def test_coherence_is_the_share_of_power_that_goes_together() -> None:
    # Truth: white noise with as much of its own beside it has coherence 1/2 everywhere, two noises with nothing in common have 1/n of n
    # frequencies; deviations of the estimates are sqrt(2 C) (1 - C) / sqrt(n) and 1/n.
    rng = np.random.default_rng(1)
    common, own, other = rng.standard_normal((3, ROWS))
    n = averages([common], [STEP_S])
    assert n.sum() == ROWS / 2  # all frequencies up to 50 Hz, 0 among them, 50 Hz not
    wide = n > 50
    shared = coherence([common], [common + own], [STEP_S])
    assert np.all(np.abs(shared - 0.5)[wide] < 4 * 0.5 / np.sqrt(n[wide]))
    assert np.all(coherence([own], [other], [STEP_S])[wide] < 8 / n[wide])


def test_only_bands_are_named_in_which_the_error_goes_with_what_is_taken_off() -> None:
    # Truth: an error of 3 Hz is taken off. What a hypothesis adds of its own at 30 Hz, louder, was never in the error.
    rng = np.random.default_rng(2)
    noise, swing, own = rng.standard_normal(ROWS), 0.5 * np.sin(2 * np.pi * 3.0 * T_S), np.sin(2 * np.pi * 30.0 * T_S)
    before, after = (noise + swing)[:, None], (noise + own)[:, None]
    case = SimpleNamespace(flights=[SimpleNamespace(step_s=STEP_S)])
    (band,) = band_map(case, [before], [after])  # type: ignore[arg-type]
    assert (band.from_Hz, band.to_Hz) == (2.0, 5.0)
    assert band.share == pytest.approx(0.2, abs=0.01)  # 0.5^2 beside 1^2
    # 180 frequencies of noise beside one of the swing: power 0.5^2 / 2 of 6000 rows against 180 / 3000 of 1.
    assert band.coherence == pytest.approx(0.125 / (0.125 + 180 / 3000), abs=0.05)


@pytest.mark.parametrize("place", sampled(["main", "tail"], keep=["tail"]))
def test_a_delay_shows_as_its_own_frequency_response(late: Late, place: str) -> None:
    # Truth, the rig having the stated parameters and the model not being re-tuned: D = exp(-j w tau) - 1, of size 2 sin(w tau / 2) and
    # phase -90 deg - w tau / 2, at some frequency of the band. Tolerance: three deviations, and 40 % and 6 deg as the answer is linear
    # about the flight: from an answer by finite differences it is 1 % off on the elevation, 15 % on the azimuth, where the size of the
    # delay comes out about a third too small.
    tau_s = 0.04
    linearisation = late(f"{place}_input.delay", tau_s)
    output, u = ("psi_rad", "u_M_V") if place == "main" else ("phi_rad", "u_T_V")
    rows = [row for row in error_responses(linearisation) if (row.output, row.input) == (output, u)]
    assert len(rows) > 1
    for row in rows:
        low, high = (2.0 * np.sin(np.pi * f * tau_s) for f in (row.from_Hz, row.to_Hz))
        assert 0.6 * low - 3 * row.sd < row.error < 1.4 * high + 3 * row.sd
        unsure = 6.0 + np.degrees(3 * row.sd / row.error)
        assert -90.0 - 180.0 * row.to_Hz * tau_s - unsure < np.degrees(row.phase_rad) < -90.0 + unsure


def test_a_delay_of_one_input_is_no_difference_of_the_other(late: Late) -> None:
    # Truth: the main rotor's answers are the model's; its reaction on the azimuth shares the tail's output alone.
    assert not [row for row in error_responses(late("tail_input.delay", 0.04)) if row.output == "psi_rad"]


@pytest.mark.parametrize("seed", sampled([81, 82, 83], keep=[81]))
def test_feedback_of_noise_is_no_difference(plant: BoundPlant, fly: Fly, seed: int) -> None:
    # Truth: the rig is the model. Strong air moves it, the controller answers with both inputs: they go with the error, but after it.
    case = make_case(effect_library(plant), [fly(seed, rig_seed=80, gusts=20.0)])
    assert error_responses(linearised(case, nominal_fit(case))) == ()
