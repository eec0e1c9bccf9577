"""A plant file that states how its parameters' uncertainties hang together: what is known of one tells of the other."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.decide.contradiction import contradiction
from diagnosis.explain.improved import improved_plant
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.known_before import log_prior, prior_chi_squared
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from records.correlation import Correlation
from records.log import RunLog
from records.plant import plant_text
from sim.bind import BoundPlant, bind
from sim.equilibrium import equilibrium
from sim.loop import closed_loop_log
from sim.manoeuvres import Manoeuvre
from sim.simulate import Conditions, simulate
from tests.diagnosis.nominal import nominal_fit
from tests.law_tables import ce150_table

HANG = 0.8
T_S = 0.01 * np.arange(1000)


@pytest.fixture(scope="module")
def case(plant: BoundPlant) -> Case:
    """Ten seconds with the azimuth locked, on a rig whose J_E is one deviation up; J_A is stated as correlated with it."""
    return case_of(plant, "J_A", [flown(plant, {"J_E": 1.0})])


def case_of(plant: BoundPlant, other: str, logs: list[RunLog]) -> Case:
    stated = Correlation(("J_E", other), ((1.0, HANG), (HANG, 1.0)))
    return make_case(effect_library(bind(replace(plant.plant, correlation=stated))), logs)


def flown(plant: BoundPlant, moved: dict[str, float]) -> RunLog:
    """The flight on a rig with coefficients moved by so many of their standard deviations."""
    reference = np.column_stack([0.25 * np.sin(2.5 * T_S), np.zeros(len(T_S))])
    rig, x0 = plant.p.copy(), equilibrium(plant, 0.0).x0
    for name, by in moved.items():
        rig[index(plant, name)] += by * plant.sd[index(plant, name)]
    run = simulate(
        plant, T_S, x0, ce150_table(), Conditions(reference=reference, p=rig, keep="uy", locked=("azimuth",))
    )
    assert run.u is not None
    assert run.y is not None
    log = closed_loop_log(plant, Manoeuvre("m", T_S, reference, x0), run.u, run.y, None)
    return replace(log, extra={}, locked=("azimuth",))


def index(plant: BoundPlant, name: str) -> int:
    return [str(symbol) for symbol in plant.model.parameter_symbols].index(name)


def place(case: Case, name: str) -> int:
    """The place of a coefficient in theta."""
    return case.free.tolist().index(index(case.library.bound, name))


def test_the_prior_chi_squared_is_that_of_the_joint_normal_law(case: Case) -> None:
    # Truth: (1, 1) under correlation r is 2 / (1 + r) squared deviations away, (1, -1) is 2 / (1 - r).
    for sign in (1.0, -1.0):
        theta = np.zeros(len(case.free))
        theta[[place(case, "J_E"), place(case, "J_A")]] = 1.0, sign
        hypothesis = replace(nominal_hypothesis(case, -3.0), theta=theta)
        assert prior_chi_squared(case, hypothesis, ()) == pytest.approx(2.0 / (1.0 + sign * HANG), rel=1e-9)
        assert log_prior(case, hypothesis, ()) == pytest.approx(-1.0 / (1.0 + sign * HANG), rel=1e-9)


def test_what_the_log_cannot_show_follows_what_it_shows(case: Case) -> None:
    # Truth: nothing of J_A is in these data, so it stands at its conditional mean, r times the deviation of J_E, known to sqrt(1 - r^2).
    found = nominal_fit(case)
    theta = found.hypothesis.theta
    assert abs(theta[place(case, "J_E")]) > 0.1
    assert theta[place(case, "J_A")] == pytest.approx(HANG * theta[place(case, "J_E")], rel=1e-3)
    improved = improved_plant(case, as_fitted(case, found))
    deviation = improved.parameters["J_A"].sds[0] / case.library.bound.plant.parameters["J_A"].sds[0]
    j_E = improved.parameters["J_E"].sds[0] / case.library.bound.plant.parameters["J_E"].sds[0]
    assert deviation**2 == pytest.approx(1.0 - HANG**2 * (1.0 - j_E**2), rel=1e-3)
    again = bind(improved).plant
    assert again.correlation is not None
    assert plant_text(again)


def test_without_a_stated_correlation_nothing_changes(plant: BoundPlant, case: Case) -> None:
    plain = make_case(effect_library(plant), [case.flights[0].log])
    assert plain.spread is None
    assert np.array_equal(plain.known, np.eye(len(plain.free)))
    theta = np.linspace(-1.0, 1.0, len(plain.free))
    assert plain.pull_of(theta) is theta
    assert prior_chi_squared(plain, replace(nominal_hypothesis(plain, -3.0), theta=theta), ()) == float(theta @ theta)


def test_two_rigs_that_differ_against_the_correlation_gain_less_by_numbers_of_their_own(plant: BoundPlant) -> None:
    # Truth: each is one deviation off in both coefficients, to sides that the correlation holds for unlikely.
    rigs = [{"J_E": sign, "b_vE": -sign} for sign in (1.0, -1.0)]
    case = case_of(plant, "b_vE", [flown(plant, moved) for moved in rigs])
    found = nominal_fit(case)
    told, free = contradiction(case, found), contradiction(replace(case, spread=None), found)
    assert told is not None
    assert free is not None
    assert told.gain < 0.99 * free.gain
