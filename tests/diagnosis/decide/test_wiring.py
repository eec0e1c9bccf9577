"""Columns with a wrong sign or in each other's place are named; a plant that lacks something is not taken for one that is wired wrongly."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.decide.columns import is_refused, is_strained
from diagnosis.decide.turned import turned_within
from diagnosis.decide.wiring import demand_wiring, likelier_wiring
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import EffectLibrary, effect_library
from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant
from tests.diagnosis.arm import arm, arm_log
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit
from tests.plants import bound
from tests.recorded import recorded
from tests.replay.firmware_flights import rows_of
from tests.soak import SOAK, sampled

SECONDS = 6.0 if SOAK else 4.0
EFFECTS = [
    {"azimuth.cable_spring": {"k": 0.01, "angle_0": 0.2, "h": 0.0}},
    {"azimuth.coulomb": {"b": 0.004}},
    {"tail_rotor.reverse_asymmetry": {"r": 0.4}},
]
LATE_ROWS = 12
SLIPS = [
    (("u", 1), "u_T_V has the wrong sign"),
    (("y", 0), "psi_rad has the wrong sign"),
    (("y", 1), "phi_rad has the wrong sign"),
    (("u", None), "u_M_V and u_T_V stand in each other's place"),
    (("y", None), "psi_rad and phi_rad stand in each other's place"),
]


@pytest.fixture(scope="module")
def library(plant: BoundPlant) -> EffectLibrary:
    return effect_library(plant)


def turned(log: RunLog, block: str, place: int) -> RunLog:
    columns = getattr(log, block).copy()
    columns[:, place] *= -1.0
    return replace(log, **{block: columns})  # type: ignore[arg-type]


def swapped(log: RunLog, block: str) -> RunLog:
    return replace(log, **{block: getattr(log, block)[:, ::-1].copy()})  # type: ignore[arg-type]


def demanded(case: Case) -> None:
    demand_wiring(case, nominal_fit(case), nominal_fit, "the logs to explain", ["one", "other"])


def test_the_columns_of_a_plant_that_follows_its_logs_are_not_doubted(library: EffectLibrary, fly: Fly) -> None:
    def never(_: Case) -> Fit:
        raise AssertionError("asked")

    case = make_case(library, [fly(31, seconds=SECONDS)])
    demand_wiring(case, nominal_fit(case), never, "the logs to explain", ["one", "other"])


# The first is refused in every suite by the verb: tests/twinlaw/verbs/test_diagnose.py.
@pytest.mark.parametrize(("slip", "named"), sampled(SLIPS, keep=SLIPS[3:4]))
def test_a_slip_of_the_columns_is_refused_by_name(
    library: EffectLibrary, fly: Fly, slip: tuple[str, int | None], named: str
) -> None:
    block, place = slip
    log = fly(31, seconds=SECONDS)
    spoiled = swapped(log, block) if place is None else turned(log, block, place)
    with pytest.raises(BadInput, match=named):
        demanded(make_case(library, [spoiled]))


@pytest.mark.parametrize(
    "effects", sampled(EFFECTS, keep=EFFECTS[2:]), ids=[next(iter(effects)) for effects in EFFECTS]
)
def test_a_plant_that_lacks_something_is_not_taken_for_one_wired_wrongly(
    library: EffectLibrary, fly: Fly, effects: dict[str, dict[str, float]]
) -> None:
    case = make_case(library, [fly(32, effects, SECONDS)])
    assert likelier_wiring(case, nominal_fit) is None


def test_an_input_whose_sign_turns_within_a_log_is_refused_with_the_log_and_the_time() -> None:
    """Truth: the arm's input is logged as -u from 2 s to 3 s of the second of two logs; tolerance: three rows."""
    straight, log = (arm_log(seed=seed, seconds=5.0) for seed in (3, 4))
    log.u[200:300] *= -1.0
    case = make_case(effect_library(arm()), [straight, log])
    named = r"u_V has the wrong sign in other from (1\.9[789]|2|2\.0[123]) s to (2\.9[789]|3|3\.0[123]) s"
    with pytest.raises(BadInput, match=rf"got {named}.*turn the sign of u_V in other from .*--from"):
        demand_wiring(case, plain_fit(case), plain_fit, "the logs to explain", ["one", "other"])


def rubs() -> RunLog:
    return arm_log({"arm.coulomb": {"b": 2e-3}}, seed=4, seconds=4.0)


def comes_late() -> RunLog:
    """The input acts 0.12 s after it was logged."""
    log = arm_log(seed=4, seconds=4.0, begins_s=1.0)
    log.u[:-LATE_ROWS] = log.u[LATE_ROWS:].copy()
    return log


def lasts(rows: int) -> RunLog:
    """The input is logged as -u for so many rows."""
    log = arm_log(seed=4, seconds=5.0)
    log.u[200 : 200 + rows] *= -1.0
    return log


def test_what_turns_and_turns_back_within_a_second_is_no_sign_that_somebody_turned() -> None:
    """Truth: nobody plugs in and back so fast; 0.9 s and 1.1 s, tolerance: three rows."""
    brief, long = (turned_within(make_case(effect_library(arm()), [lasts(rows)])) for rows in (90, 110))
    assert not brief
    assert [abs(edge - truth) <= 3 for edge, truth in zip(long[0].rows[0], (200, 310), strict=True)] == [True, True]


@pytest.mark.parametrize("lacking", [rubs, comes_late])
def test_an_arm_that_lacks_something_has_no_sign_that_turns(lacking: Callable[[], RunLog]) -> None:
    """Truth: no column is turned; though some rows may be likelier so, they are likelier still without the column."""
    case = make_case(effect_library(arm()), [lacking()])
    assert is_strained(case, plain_fit(case))
    assert not turned_within(case)
    assert likelier_wiring(case, plain_fit) is None


def test_numbers_without_meaning_are_not_taken_for_a_slip(library: EffectLibrary, fly: Fly) -> None:
    log, rng = fly(33, seconds=SECONDS), np.random.default_rng(3)
    walk = np.cumsum(rng.normal(0.0, 0.004, log.y.shape), axis=0)
    case = make_case(library, [replace(log, y=np.clip(walk, -0.7, 0.7))])
    found = likelier_wiring(case, nominal_fit)
    assert found is None or not is_refused(found[1])


@pytest.mark.soak
def test_the_sign_of_an_input_that_the_plant_answers_alike_either_way_is_said_to_be_unseen() -> None:
    """Truth: thrusts of the Aero's published equations go with the square of the voltage."""
    log = recorded("quanser_aero", "yaw_coefficients")
    case = make_case(effect_library(bound("quanser_aero")), [log])
    nominal = plain_fit(case)
    assert [note.kind for note in demand_wiring(case, nominal, plain_fit, "the log", ["log"])] == ["sign_unseen"]


def test_a_turned_sign_that_is_likelier_but_not_surely_is_told() -> None:
    """Truth: as recorded no column is doubted; with the torque's sign turned the plant as stated follows 33 nats worse."""
    library, log = effect_library(bound("torque_limited_pendulum")), recorded("torque_limited_pendulum", "sac")

    def told(log: RunLog) -> list[str]:
        case = make_case(library, [log])
        return [str(note.said) for note in demand_wiring(case, plain_fit(case), plain_fit, "the log", ["log"])]

    assert told(log) == []
    (said,) = told(turned(log, "u", 0))
    assert said.startswith("perhaps ")
    assert "tau_Nm has the wrong sign" in said


@pytest.mark.soak
def test_a_start_that_only_logs_together_show_is_no_turned_sign() -> None:
    """Truth: a motor that comes late to its one impulse, in 3 s before a gap of its log. Beside calmer logs, whose noise they share, the
    angle read backwards seemed 80 nats likelier."""
    times = ("48_45", "49_36", "50_18")
    first, *others = (recorded("aeroshield_two_clocks", f"impulse_char_2026_01_24_22_{time}") for time in times)
    stretch = rows_of(first, np.arange(len(first.t_s)) < 69)
    case = make_case(effect_library(bound("aeroshield_two_clocks")), [stretch, *others])
    assert likelier_wiring(case, plain_fit) is None


@pytest.mark.soak
def test_a_turned_sign_is_told_of_a_rig_that_is_far_from_its_plant_file_and_no_sign_of_the_recording_as_it_is() -> None:
    """Truth: the carriage is alike both ways round, so that voltage and place may either be turned; as recorded neither is."""
    whole = recorded("emps", "DATA_EMPS")
    rows = slice(0, 6000, 3)  # 6 s
    log = replace(whole, t_s=whole.t_s[rows], u=whole.u[rows], y=whole.y[rows], extra={}, sample_period_s=0.003)
    library = effect_library(bound("emps"))
    demand_wiring(make_case(library, [log]), nominal_fit(make_case(library, [log])), nominal_fit, "the log", ["log"])
    with pytest.raises(BadInput, match=r"(u_V|q_m) has the wrong sign, or (q_m|u_V) has the wrong sign"):
        demanded(make_case(library, [turned(log, "y", 0)]))
