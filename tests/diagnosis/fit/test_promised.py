"""What a step to the top of the linear problem promises, against the fit that goes there: of a point, and of a move of columns."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from diagnosis.decide.rows import Asked, Misplaced, moved
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import Hypothesis, nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from tests.diagnosis.arm import arm_case, arm_log
from tests.own_plants import WHEEL, OwnPlant

PERIOD_S, ROWS = 0.01, 400
SHIFTS = [Misplaced((0,), rows) for rows in (1, -1, 3, -3)]
# A wheel of which all is known but the gain of its input: readings are linear in that one number.
K, K_SD, DAMPING, INERTIA = 0.05, 0.01, 0.02, 0.01
KNOWN = {"J": (INERTIA, 0.0, "kg m^2"), "K": (K, K_SD, "N m V^-1"), "b": (DAMPING, 0.0, "N m s")}


@pytest.fixture(scope="module")
def linear(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """The wheel's exact answer to steps, its gain one standard deviation above what its file states."""
    folder: Path = tmp_path_factory.mktemp("wheel")
    plant = bind(load_plant(OwnPlant(KNOWN, WHEEL.sensors, WHEEL.body).write(folder, "wheel")))
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(-2.0, 2.0, ROWS // 20), 20)
    keep = np.exp(-DAMPING / INERTIA * PERIOD_S)
    speed = lfilter([0.0, 1.0 - keep], [1.0, -keep], (K + K_SD) / DAMPING * u)
    (step,) = WHEEL.sensors.values()
    y = step * np.round((speed + 2.0 * step * rng.standard_normal(ROWS)) / step)
    log = RunLog(log_columns(plant.model), PERIOD_S, "open", PERIOD_S * np.arange(ROWS), u[:, None], y[:, None])
    return make_case(effect_library(plant), [log])


def fitted(case: Case, start: Hypothesis, rounds: int = 20) -> Fit:
    found = fit(case, start, rounds=rounds)
    assert found is not None
    return found


def test_what_a_point_promises_is_what_a_fit_from_there_gains(linear: Case) -> None:
    start = nominal_hypothesis(linear, -3.0)
    at, end = fitted(linear, start, rounds=0), fitted(linear, start)
    # Truth: a linear problem, so that the first step is at the top. Tolerance: slopes are of second order in a row's length.
    assert at.promised == pytest.approx(end.log_posterior - at.log_posterior, rel=1e-4)
    assert at.promised > 1000.0
    assert end.promised == pytest.approx(0.0, abs=1e-3)
    # The arm's gravity is not linear: the same order of size.
    case = arm_case(arm_log(seed=31, seconds=6.0))
    stated = nominal_hypothesis(case, -2.0)
    for theta in (stated.theta, stated.theta + 1.0):
        start = replace(stated, theta=theta)
        at, end = fitted(case, start, rounds=0), fitted(case, start)
        assert 0.5 < at.promised / (end.log_posterior - at.log_posterior) < 2.0


def test_what_a_move_of_columns_promises_is_what_a_fit_to_it_gains(linear: Case) -> None:
    def gained(case: Case, usual: Fit, slip: Misplaced) -> float:
        return fitted(moved(case, slip), usual.hypothesis).log_posterior - usual.log_posterior

    usual = fitted(linear, nominal_hypothesis(linear, -3.0))
    for slip in SHIFTS:
        assert Asked(linear, usual).promised(slip) == pytest.approx(gained(linear, usual, slip), rel=1e-4)
    case = arm_case(arm_log(seed=31, seconds=6.0))
    usual = fitted(case, nominal_hypothesis(case, -2.0))
    for slip in SHIFTS:
        assert 0.5 < Asked(case, usual).promised(slip) / gained(case, usual, slip) < 2.0
