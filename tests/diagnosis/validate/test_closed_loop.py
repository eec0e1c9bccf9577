"""The loop closed again by the log's own law: the true model leaves what rounding leaves, one that lacks the spring leaves more."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.validate.closed_loop import closed_loop, refly
from records.log import RunLog
from sim.added_effects import with_effects
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium
from sim.loop import fly
from sim.manoeuvres import Leg, Manoeuvre, manoeuvre
from tests.law_tables import ce150_table
from verification.host_law import host_law

SPRING = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.2, "h": 0.0}}
STEP_RAD = 2.0 * np.pi / 4096.0


@pytest.fixture(scope="module")
def log(plant: BoundPlant) -> RunLog:
    """Twelve seconds of steps of both axes on a rig with a spring."""
    legs = ((Leg(0.0, -10.0), Leg(1.0, 10.0), Leg(6.0, -15.0)), (Leg(0.0, 0.0), Leg(2.0, 40.0), Leg(7.0, -50.0)))
    steps: Manoeuvre = manoeuvre("steps", equilibrium(plant, np.radians(-10.0)).x0, 12.0, 0.01, legs)
    table = ce150_table()
    return fly(with_effects(plant, SPRING), host_law(table), steps, table_digest=table.digest)


@pytest.fixture(scope="module")
def case(plant: BoundPlant, log: RunLog) -> Case:
    return make_case(effect_library(plant), [log])


def test_the_true_model_flies_the_log_and_one_without_the_spring_does_not(case: Case) -> None:
    # Truth: the rig had no process noise, so the model with its spring errs by rounding alone: under two counts in every output.
    without = nominal_hypothesis(case, -4.0)
    variants = {"nominal": without, "before": without, "after": without.with_effects(SPRING)}
    found = closed_loop(case, ["hold"], [ce150_table()], variants)
    assert found is not None
    assert found.logs == ("hold",)
    assert found.diverged == ()
    assert set(found.rms_after) == {"psi_rad", "phi_rad", "u_M_V", "u_T_V"}
    assert max(found.rms_after["psi_rad"], found.rms_after["phi_rad"]) < 2.0 * STEP_RAD
    assert found.rms_before == found.rms_nominal
    assert found.rms_before["phi_rad"] > 5.0 * found.rms_after["phi_rad"]
    assert found.fraction == pytest.approx(1.0, abs=0.05)
    assert found.fraction_ci95 is not None
    assert found.fraction_ci95[0] <= found.fraction <= found.fraction_ci95[1]


def test_a_flight_that_leaves_the_log_is_called_diverged(case: Case) -> None:
    without = nominal_hypothesis(case, -4.0)
    runaway = without.with_effects({"azimuth.cable_spring": {"k": -0.05, "angle_0": -1.0, "h": 0.0}})
    found = closed_loop(case, ["hold"], [ce150_table()], {"nominal": runaway, "before": without, "after": without})
    assert found is not None
    assert found.diverged == ("nominal",)
    assert found.fraction is None
    assert all(np.isfinite([*found.rms_nominal.values(), *found.rms_floor.values()]))


def test_rows_that_are_missing_are_flown_through(plant: BoundPlant, log: RunLog) -> None:
    # Truth: the same flight with a tenth of its rows lost tells the same of the true model.
    kept = np.random.default_rng(1).random(len(log.t_s)) > 0.1
    kept[0] = True
    extra = {name: column[kept] for name, column in log.extra.items()}
    torn = replace(log, t_s=log.t_s[kept], u=log.u[kept], y=log.y[kept], extra=extra)
    case = make_case(effect_library(plant), [torn])
    without = nominal_hypothesis(case, -4.0)
    variants = {"nominal": without, "before": without, "after": without.with_effects(SPRING)}
    found = closed_loop(case, ["hold"], [ce150_table()], variants)
    assert found is not None
    assert found.rms_after["phi_rad"] < 4.0 * STEP_RAD
    assert found.rms_before["phi_rad"] > 3.0 * found.rms_after["phi_rad"]


def test_logs_without_a_table_are_not_flown(case: Case) -> None:
    without = nominal_hypothesis(case, -4.0)
    assert closed_loop(case, ["hold"], [None], dict.fromkeys(("nominal", "before", "after"), without)) is None


def test_only_the_first_samples_of_a_long_log_are_flown(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    # Truth: the spring's flights of the first 200 samples behind the lead of 2 s are those of the whole flight, cut.
    without = nominal_hypothesis(case, -4.0)
    variants = dict.fromkeys(("nominal", "before", "after"), without)
    whole = refly(case, "hold", ce150_table(), variants)
    monkeypatch.setattr("diagnosis.validate.closed_loop.MOST_SAMPLES", 200)
    cut = refly(case, "hold", ce150_table(), variants)
    assert whole is not None
    assert cut is not None
    assert len(cut.t_s) == 200
    assert np.array_equal(cut.errors["after"], whole.errors["after"][:200])
