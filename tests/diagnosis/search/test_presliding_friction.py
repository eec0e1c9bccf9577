"""Friction near rest, which a plant file leaves open: axes that creep or give are no gap; and speeds that a log has in whole counts."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.diagnose import Material, diagnose
from diagnosis.filter.filter_input import filter_input_of
from diagnosis.fit.evidence import FittedHypothesis, as_fitted, log_evidence
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.search.presliding_friction import Yielding, changes_names, needed, yielding
from records.log import RunLog
from sim.added_effects import with_effects, without_effects
from sim.bind import BoundPlant, bind
from sim.loop import fly_law
from sim.manoeuvres import flight
from sim.model import Model
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit
from tests.plants import lively_table
from tests.soak import SOAK, sampled

V_C_RAD_S = 0.005
LEVEL_N_M = 3e-4
Z_0_RAD = 0.003
LONG_S, WHOLE_S = 40.0, 70.0
SECONDS = LONG_S if SOAK else 30.0
GIVE = {"elevation.bristles": {"z_0": Z_0_RAD}, "azimuth.bristles": {"z_0": Z_0_RAD}}
DRAG = "elevation.quadratic_drag"
CREEP = {"elevation.creep": {"v_c": V_C_RAD_S}, "azimuth.creep": {"v_c": V_C_RAD_S}}


def default_flight(plant: BoundPlant, effects: Mapping[str, Mapping[str, float]], seconds: float = SECONDS) -> RunLog:
    """The default flight in still air, or so much of it, with holds in which an axis that sticks stays where it is."""
    log = fly_law(with_effects(plant, effects), lively_table(), flight(plant))
    rows = slice(round(seconds / log.sample_period_s))
    return replace(log, t_s=log.t_s[rows], u=log.u[rows], y=log.y[rows], extra={})


def plain_fit(plant: BoundPlant, log: RunLog, **stated: BoundPlant) -> tuple[Case, FittedHypothesis]:
    """The log as a case, and the plant as stated fitted to it."""
    case = make_case(effect_library(plant), [log], **stated)
    nominal = nominal_fit(case)
    return case, FittedHypothesis((), nominal, log_evidence(nominal, case.library.effects))


@pytest.fixture(scope="module")
def giving(plant: BoundPlant) -> tuple[Case, FittedHypothesis]:
    """A flight of a rig whose friction is a brush that slides after 3 mrad, two encoder steps."""
    return plain_fit(
        plant, default_flight(plant, {**GIVE, DRAG: {}})
    )  # at no size, for one kernel with the other flight


@pytest.fixture(scope="module")
def sticking(plant: BoundPlant) -> tuple[Case, FittedHypothesis]:
    """A flight of the rig as stated."""
    return plain_fit(plant, default_flight(plant, {}))


def friction_N_m(model: Model, speed_rad_s: float, v_c_rad_s: float) -> float:
    """The azimuth's level of friction where its own is LEVEL_N_M."""
    level = next(axis for axis in model.axes if axis.name == "azimuth").coulomb
    known = {"b_cA": LEVEL_N_M, "phi_dot_rad_s": speed_rad_s, "azimuth_creep_v_c": v_c_rad_s}
    return float(level.xreplace({symbol: known[str(symbol)] for symbol in level.free_symbols}))


@pytest.fixture(scope="module")
def creeps(plant: BoundPlant) -> Model:
    return with_effects(plant, {"azimuth.creep": {"v_c": V_C_RAD_S}}).model


def test_friction_builds_up_with_speed_as_a_hyperbolic_tangent(creeps: Model) -> None:
    # A hundredth of the level stays at rest.
    for speed in (-0.3, -0.004, 0.001, 0.005, 0.02, 2.0):
        truth = LEVEL_N_M * np.tanh(abs(speed) / V_C_RAD_S)
        assert friction_N_m(creeps, speed, V_C_RAD_S) == pytest.approx(truth, abs=0.01 * LEVEL_N_M)


def test_without_a_speed_friction_is_dry(creeps: Model) -> None:
    for speed in (-0.3, 0.0, 1e-9):
        assert friction_N_m(creeps, speed, 0.0) == LEVEL_N_M


@pytest.mark.soak
def test_axes_that_creep_are_taken_to(plant: BoundPlant) -> None:
    # Truth: the plant as stated, the jump of its friction rounded off over 5 mrad/s.
    case, nominal = plain_fit(plant, default_flight(plant, CREEP, WHOLE_S))
    told = yielding(case, [nominal])
    creeping, rules = told.case, told.decisions
    assert set(creeping.stated) == set(CREEP)
    for name in CREEP:
        assert creeping.stated[name]["v_c"] == pytest.approx(V_C_RAD_S, rel=0.2)
    assert [rule.outcome for rule in rules] == ["axes yield"]


@pytest.mark.soak
def test_a_rig_that_creeps_has_no_gap(plant: BoundPlant) -> None:
    result = diagnose(plant, Material([default_flight(plant, CREEP, WHOLE_S)], [], [], []))
    assert result.diagnosis.verdict == "no gap"


@pytest.mark.soak
def test_what_axes_that_creep_would_hide_is_named(plant: BoundPlant) -> None:
    # Truth: the elevation is read 25 ms late, and its friction builds up over 20 mrad/s.
    creep = {name: {"v_c": 4.0 * V_C_RAD_S} for name in CREEP}
    log = default_flight(plant, {**creep, "psi_sensor.delay": {"tau": 0.025}}, WHOLE_S)
    found = diagnose(plant, Material([log], [], [], [])).diagnosis
    late = {entry.effect: entry for entry in found.effects[:2]}["psi_sensor.delay"]
    assert late.parameters["tau"].value == pytest.approx(0.025, rel=0.1)


@pytest.mark.soak
def test_axes_that_give_before_they_slide_are_taken_to(giving: tuple[Case, FittedHypothesis]) -> None:
    case, nominal = giving
    hypothesis = yielding(case, [nominal]).case.stated
    assert set(hypothesis) == set(GIVE)
    for name in GIVE:
        assert hypothesis[name]["z_0"] == pytest.approx(Z_0_RAD, rel=0.2)


# That they are kept where a rig gives is seen in every suite above, where they are found.
@pytest.mark.soak
@pytest.mark.parametrize("flown", sampled(["giving", "sticking"], keep=["sticking"]))
def test_axes_that_give_are_kept_only_where_the_logs_need_it(flown: str, request: pytest.FixtureRequest) -> None:
    # Truth: a rig whose friction gives over 3 mrad, and one that sticks, each as fitted by a plant that gives.
    plain, _ = request.getfixturevalue(flown)
    taken = replace(plain, stated=GIVE, stated_sd={name: {"z_0": 0.0} for name in GIVE})
    found = nominal_fit(taken)
    assert needed(plain, FittedHypothesis((), found, log_evidence(found, taken.library.effects))) is (flown == "giving")


@pytest.mark.soak
def test_axes_give_only_for_what_is_asked_of_them(giving: tuple[Case, FittedHypothesis]) -> None:
    # Truth: no flight of half a minute is a million nats likelier for its friction.
    case, nominal = giving
    with decisions.changed("TAKEN_IN", 1e6):
        assert yielding(case, [nominal]).case is case


@pytest.mark.soak
def test_what_the_plant_file_states_stays_as_stated_where_axes_give(plant: BoundPlant) -> None:
    # Truth: the file states a drag of 2e-3 with 5 %, the rig has twice that, and its friction gives.
    stated = with_effects(plant, {DRAG: {"c": 2e-3}}, sd={DRAG: {"c": 1e-4}})
    log = default_flight(plant, {**GIVE, DRAG: {"c": 4e-3}}, LONG_S)
    case, nominal = plain_fit(without_effects(stated), log, stated=stated)
    assert nominal.fit.hypothesis.effects[DRAG]["c"] != pytest.approx(2e-3, rel=0.01)
    found = yielding(case, [nominal]).case
    assert set(found.stated) == {DRAG, *GIVE}
    assert found.stated[DRAG] == {"c": 2e-3}
    assert found.stated_sd[DRAG] == {"c": 1e-4}


@pytest.mark.soak
def test_dry_friction_that_gives_keeps_its_name(plant: BoundPlant) -> None:
    # Truth: a plant file without friction of the azimuth; the rig has a brush there that slides after 3 mrad.
    free = bind(
        replace(
            plant.plant,
            parameters={**plant.plant.parameters, "b_cA": replace(plant.plant.parameters["b_cA"], value=0.0, sd=0.0)},
        )
    )
    result = diagnose(free, Material([default_flight(plant, GIVE)], [], [], []))
    assert result.diagnosis.effects[0].effect == "azimuth.coulomb"
    assert result.diagnosis.effects[0].parameters["b"].value == pytest.approx(plant.parameter("b_cA"), rel=0.1)
    assert sum("springs back" in note for note in result.diagnosis.notes) == 2


def test_an_axis_without_friction_is_not_taken_to_yield() -> None:
    case = arm_case(arm_log(seconds=6.0))
    nominal = as_fitted(case, nominal_fit(case))
    assert yielding(case, [nominal]).case is case
    assert not needed(case, nominal)


@pytest.mark.soak  # a cold library of the largest plant
def test_axes_that_stick_are_not_taken_to_yield(sticking: tuple[Case, FittedHypothesis]) -> None:
    case, nominal = sticking
    assert yielding(case, [nominal]).case is case


def test_a_speed_in_whole_counts_is_known_to_a_count(plant: BoundPlant, fly: Fly) -> None:
    # Truth: readings of 0.5 rad/s that stand still in most rows are off by 0.5 / sqrt(12), not by nothing.
    log = fly(34, rig_seed=3)
    speed = np.round(np.linspace(400.0, 410.0, len(log.t_s)) / 0.5) * 0.5
    library = effect_library(plant)
    filter_input = filter_input_of(replace(log, extra={"omega_M_rad_s": speed}), plant.plant, library.outputs)
    single = filter_input.single[library.outputs.index("omega_M_rad_s")]
    assert np.sqrt(single) == pytest.approx(0.5 / np.sqrt(12.0), rel=0.01)


@pytest.mark.parametrize(
    ("beside", "gain_nats", "anew"),
    [(("a.b",), 20.0, False), (("a.b",), 40.0, True), (("a.c",), 20.0, True), ((), 20.0, True)],
)
def test_yields_beside_the_best_names_are_worth_a_search_where_they_may_change_them(
    sticking: tuple[Case, FittedHypothesis], beside: tuple[str, ...], gain_nats: float, anew: bool
) -> None:
    # Truth by hand: the best gains 1000 nats over the plant alone, of which a name must gain 30 to stand beside or instead of it.
    case, plain = sticking
    best = replace(plain, effects=("a.b",), evidence=plain.evidence + 1000.0)
    there = Yielding(case, replace(best, effects=beside, evidence=best.evidence + gain_nats), ())
    assert changes_names(there, best, plain)[0] is anew
    assert not changes_names(Yielding(case, None, ()), best, plain)[0]
