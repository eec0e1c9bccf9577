"""The filter: innovations white when model and noise are the truth's, slopes equal to finite differences, answers linear."""

import numpy as np
import pytest

from diagnosis.case import Case, make_case
from diagnosis.engine import nominal_fit
from diagnosis.fit import fit
from diagnosis.hypothesis import Supposed, nothing_supposed, passes
from diagnosis.kit import Kit, make_kit
from diagnosis.predict import predictions
from sim.bind import BoundPlant
from tests.diagnosis.conftest import Fly


@pytest.fixture(scope="module")
def kit(plant: BoundPlant) -> Kit:
    return make_kit(plant)


@pytest.fixture(scope="module")
def case(kit: Kit, fly: Fly) -> Case:
    return make_case(kit, [fly(1)])


@pytest.fixture(scope="module")
def settled(case: Case) -> Supposed:
    return nominal_fit(case).supposed


def test_innovations_of_the_fitted_plant_are_white(case: Case, settled: Supposed) -> None:
    # Some 2000 readings that change from row to row have unit variance: the mean square within 6 sd = 19 %, the first correlation
    # within 6/sqrt(2000) = 0.13 and a little more for the encoder's rounding. Readings that stand are trusted less than they deserve.
    (run,) = passes(case, settled) or [None]
    assert run is not None
    (flight,) = case.flights
    for place, w in enumerate(run.w[200:].T):
        moving = flight.tape.r[200:, place] < 1.01 * flight.tape.single[place]
        assert moving.sum() > 1500
        assert np.mean(w[moving] ** 2) == pytest.approx(1.0, abs=0.2)
        assert np.mean(w[~moving] ** 2) < 1.25
        assert abs(np.mean(w[1:] * w[:-1])) < 0.2


@pytest.mark.parametrize("sensor", ["psi_sensor", "phi_sensor"])
def test_further_instants_change_nothing(kit: Kit, fly: Fly, sensor: str) -> None:
    # A delay of 10 us gives each reading an instant of its own: the likelihood moves by less than half a nat, though the azimuth sticks.
    sticky = {"azimuth.coulomb": {"b": 2e-3}}
    case = make_case(kit, [fly(1, sticky)])
    fitted = fit(case, nothing_supposed(case, -3.0).with_effects(sticky))
    assert fitted is not None
    supposed = fitted.supposed
    (plain,) = passes(case, supposed) or [None]
    (late,) = passes(case, supposed.with_effects({**supposed.effects, f"{sensor}.delay": {"tau": 1e-5}})) or [None]
    assert plain is not None
    assert late is not None
    assert np.mean(np.abs(np.diff(case.flights[0].log.y[:, 1])) == 0.0) > 0.15
    assert late.log_likelihood == pytest.approx(plain.log_likelihood, abs=0.5)


def test_slopes_are_those_of_small_changes(case: Case, settled: Supposed) -> None:
    # The slopes leave out how the gain and the instants of stiction move: 20 % of their size, for parameters without friction.
    names = [str(symbol) for symbol in case.kit.bound.model.parameter_symbols]
    for name in ("J_E", "K_M", "tau_gE", "K_T"):
        index = int(np.flatnonzero(case.free == names.index(name))[0])
        (run,) = passes(case, settled, case.free.tolist(), slopes=True) or [None]
        theta = settled.theta.copy()
        theta[index] += 1e-3
        (moved,) = passes(case, Supposed(theta, {}, settled.unrest)) or [None]
        assert run is not None
        assert moved is not None
        assert run.dw is not None
        change = (moved.w - run.w)[100:] / 1e-3
        slope = run.dw[100:, :, index] * case.sd[index]
        assert np.linalg.norm(change - slope) < 0.2 * np.linalg.norm(change)


def test_products_are_those_of_the_slopes(case: Case, settled: Supposed) -> None:
    (run,) = passes(case, settled, case.free.tolist()[:5], slopes=True) or [None]
    assert run is not None
    assert run.dw is not None
    dw, w = np.nan_to_num(run.dw).reshape(-1, 5), np.nan_to_num(run.w).ravel()
    assert np.allclose(run.gram, dw.T @ dw, rtol=1e-9)
    assert np.allclose(run.pull, dw.T @ w, rtol=1e-6, atol=1e-6 * np.abs(run.gram).max())


def test_predictions_begin_at_what_was_read(case: Case, settled: Supposed) -> None:
    # At a window's first row the filter has seen the reading: within two encoder steps of it.
    flight = case.flights[0]
    found = predictions(case, flight, settled)
    starts = np.arange(300, 3000, 100)
    assert np.abs(found[starts] - flight.log.y[starts]).max() < 2 * 1.54e-3
    assert np.isnan(found[:200]).all()


def test_a_plant_of_other_parameters_predicts_worse(case: Case, settled: Supposed) -> None:
    flight = case.flights[0]
    own = predictions(case, flight, settled) - flight.log.y
    stated = predictions(case, flight, nothing_supposed(case, -3.0)) - flight.log.y
    assert np.nanmean(own**2) < 0.5 * np.nanmean(stated**2)
