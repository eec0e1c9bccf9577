"""The fit ends where the likelihood is largest, whatever the air."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.likelihood import likelihood
from diagnosis.hypothesis.case import make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis, passes
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from sim.bind import BoundPlant
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit

LAG, LAG_S = "phi_sensor.lag", 0.1
GUSTS = 300.0  # times the usual: most of what the readings show is the air's


def lagging(log: RunLog) -> RunLog:
    """The run with its azimuth read behind a lag, each reading a straight way from the one before."""
    y = log.y.copy()
    true, h = y[:, 1].copy(), log.sample_period_s
    keep = np.exp(-h / LAG_S)
    behind = LAG_S * (1.0 - keep) / h  # share of a straight way's change that has not arrived at its end
    for k in range(1, len(y)):
        y[k, 1] = true[k] - (true[k] - true[k - 1]) * behind + keep * (y[k - 1, 1] - true[k - 1])
    return replace(log, y=y)


@pytest.mark.parametrize("start_s", [0.04, 0.2])
def test_a_lag_that_smooths_the_air_is_fitted_by_what_it_does_to_the_air_too(
    plant: BoundPlant, fly: Fly, start_s: float
) -> None:
    case = make_case(effect_library(plant), [lagging(fly(7, seconds=20.0, gusts=GUSTS))])
    start = nominal_hypothesis(case, np.log10(1e-3 * GUSTS)).with_effects({LAG: {"tau": start_s}})
    found = fit(case, start, rounds=20)
    assert found is not None

    def at(tau_s: float) -> float:
        runs = passes(case, replace(found.hypothesis, effects={LAG: {"tau": tau_s}}))
        return -np.inf if runs is None else likelihood(runs)

    tau_s = found.hypothesis.effects[LAG]["tau"]
    assert found.log_likelihood == pytest.approx(at(tau_s), abs=1e-6)
    # Truth: the top of the likelihood itself, the plant held. Tolerance: what ends a fit, a tenth of a nat.
    assert max(at(tau) for tau in np.geomspace(0.5, 2.0, 41) * tau_s) < found.log_likelihood + 0.1


@pytest.mark.parametrize(
    ("name", "truth", "start"),
    [
        ("input.saturation", {"limit": 2.0, "w": 0.0}, {"limit": 0.8, "w": 0.0}),
        ("input.lag", {"tau": 0.05, "b": 0.0}, {"tau": 0.02, "b": 0.0}),
    ],
)
def test_a_step_that_is_far_too_long_is_shortened_until_it_gains(
    name: str, truth: dict[str, float], start: dict[str, float]
) -> None:
    # Truth: an effect of other size, while the plant alone is as it went astray for want of it: the first step to its top leaves all hills,
    # and a lag's second part, of which nothing is told while it has no size, must not go to its end in every shorter one. From its start
    # it gets at least to where the plant alone is as likely.
    case = arm_case(arm_log({name: truth}, seed=1 if name == "input.saturation" else 2))
    plain = nominal_fit(case)
    found = fit(case, plain.hypothesis.with_effects({name: start}))
    assert found is not None
    assert found.log_posterior > plain.log_posterior
