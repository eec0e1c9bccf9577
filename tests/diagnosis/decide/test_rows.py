"""Commands that stand a row or two late or early in a log are named; a plant that lacks something is not taken for a misplaced column."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide import rows
from diagnosis.decide.rows import EARLY, LATE, Misplaced, demand_rows, most_by_an_effect, rows_in_doubt
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import EffectLibrary, effect_library
from diagnosis.screening import alarmed, detected
from identification.runs.rows import trimmed
from records.errors import BadInput
from records.log import RunLog
from tests.diagnosis.arm import arm, arm_log
from tests.diagnosis.conftest import RUB, Fly, without_states
from tests.plants import bound
from tests.recorded import recorded
from tests.soak import SOAK, sampled
from twinlaw import fly as flown
from twinlaw import load
from twinlaw.workflows.new_plant import plant_texts

SECONDS = 6.0
EFFECTS = [
    {"azimuth.cable_spring": {"k": 0.01, "angle_0": 0.2, "h": 0.0}},
    {"azimuth.coulomb": {"b": 0.004}},
    {"tail_rotor.reverse_asymmetry": {"r": 0.4}},
]


def logged(log: RunLog, slip: Misplaced) -> RunLog:
    """The log with columns as many rows late as `slip` says."""
    u, y, source = log.u.copy(), log.y.copy(), np.clip(np.arange(len(log.u)) - slip.rows, 0, len(log.u) - 1)
    u[:, slip.inputs], y[:, slip.outputs] = log.u[source][:, slip.inputs], log.y[source][:, slip.outputs]
    return replace(log, u=u, y=y)


def told(library: EffectLibrary, log: RunLog, ways: Sequence[int] = (LATE, EARLY)) -> list[str]:
    """Kinds of what is told of a log; raises BadInput where it is refused."""
    case = make_case(library, [log])
    return [note.kind for note in demand_rows(case, plain_fit(case), "the logs to explain", ways)]


SLIPS = [
    (Misplaced((0, 1), 1), "u_M_V and u_T_V stand one row late in the log"),
    (Misplaced((0,), 1), "u_M_V stands one row late in the log"),
    (Misplaced((1,), 2), "u_T_V stands two rows late in the log"),
    (Misplaced((0, 1), -1), "u_M_V and u_T_V stand one row early in the log, or the plant is so late"),
    (Misplaced((), -1, (0,)), "psi_rad stands one row early in the log"),
    (Misplaced((), 1, (1,)), "phi_rad stands one row late in the log, or .*the plant is so late"),
]


@pytest.mark.parametrize(("slip", "named"), sampled(SLIPS, keep=[SLIPS[n] for n in (0, 5)]))
def test_columns_in_other_rows_are_refused_by_name(
    stateless: EffectLibrary, fly: Fly, slip: Misplaced, named: str
) -> None:
    # One column alone shows half as much as both commands: twice the time, where all are asked.
    log = fly(31, seconds=2.0 * SECONDS if SOAK else SECONDS)
    with pytest.raises(BadInput, match=named):
        told(stateless, logged(log, slip))


@pytest.mark.soak
def test_commands_that_a_motor_s_log_has_a_row_late_are_named_and_made_no_physics(tmp_path: Path) -> None:
    """Its current follows within a row of 10 ms: another inductance, or inputs that move between rows, make up for a part of it."""
    for name, text in plant_texts("late_motor", "motor").items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    motor = load(tmp_path / "plant.toml")
    log = trimmed(flown(motor), 0.0, 10.0)
    with pytest.raises(BadInput, match="u_V stands one row late in the log"):
        told(without_states(effect_library(motor)), logged(log, Misplaced((0,), 1)))


def test_a_column_of_which_a_short_log_tells_little_is_told_and_not_refused(stateless: EffectLibrary, fly: Fly) -> None:
    # Truth: u_M_V stands one row late; the flight is long enough for 25 nats and too short for 50.
    assert told(stateless, logged(fly(31, seconds=SECONDS - 1.0), Misplaced((0,), 1))) == ["columns_late"]


def test_commands_that_another_reading_of_the_rows_follows_half_as_well_are_told(
    stateless: EffectLibrary, fly: Fly
) -> None:
    # Truth: u_M_V stands one row late. Inputs that go straight from row to row are half a row early, and so half as good; what is 10 nats
    # likelier than that is told, what is not is left to it.
    case = make_case(stateless, [logged(fly(31, seconds=SECONDS - 1.0), Misplaced((0,), 1))])
    nominal = plain_fit(case)
    (note,) = demand_rows(case, nominal, "the logs to explain")
    gain = note.numbers["gain_nats"]
    assert [note.kind for note in demand_rows(case, nominal, "the logs", beaten=0.5 * gain)] == ["columns_late"]
    assert demand_rows(case, nominal, "the logs", beaten=gain - 5.0) == ()


def test_commands_are_asked_as_held_where_no_gap_is_left_once_they_move_between_rows(
    stateless: EffectLibrary, fly: Fly
) -> None:
    # Truth: both commands stand one row late, and nothing is missing; inputs that go straight from row to row take up half of that.
    case = make_case(stateless, [logged(fly(31, seconds=SECONDS), Misplaced((0, 1), 1))])
    seen = detected(case, None)
    assert not alarmed(seen.detection.p)
    assert seen.held is not None
    with pytest.raises(BadInput, match="u_M_V and u_T_V stand one row late in the log"):
        demand_rows(seen.held.case, seen.held.fit, "the logs to explain", beaten=seen.held.beaten)


def test_commands_in_their_rows_are_not_doubted(stateless: EffectLibrary, fly: Fly) -> None:
    assert told(stateless, fly(31, seconds=SECONDS)) == []


def test_what_a_plant_may_be_itself_is_told_where_it_is_not_to_be_refused(stateless: EffectLibrary, fly: Fly) -> None:
    assert told(stateless, logged(fly(31, seconds=SECONDS), Misplaced((0, 1), -1)), (LATE,)) == ["columns_early"]


def test_a_delay_that_was_found_explains_commands_that_seem_early(stateless: EffectLibrary, fly: Fly) -> None:
    """Truth: the columns of both commands stand two rows early, as if both acted two rows late."""
    delays = {"main_input.delay": {"tau": 0.02}, "tail_input.delay": {"tau": 0.02}}
    case = make_case(stateless, [logged(fly(31, seconds=SECONDS), Misplaced((0, 1), -2))])
    nominal = plain_fit(case)
    notes = demand_rows(case, nominal, "the logs to explain", (LATE,))
    assert [note.kind for note in notes] == ["columns_early"]
    late = fit(case, nominal.hypothesis.with_effects(delays))
    assert late is not None
    assert rows_in_doubt(case, as_fitted(case, late), notes) == ()
    assert rows_in_doubt(case, as_fitted(case, nominal), notes) == notes


@pytest.mark.soak
def test_commands_of_a_rig_with_dry_friction_that_its_plant_file_lacks_are_seen_in_other_rows() -> None:
    """Truth: the carriage of emps has 20 N of dry friction and -3 N of constant force, in its plant file neither; 1 ms a row."""
    library, log = effect_library(bound("emps")), recorded("emps", "DATA_EMPS")
    log = replace(log, t_s=log.t_s[:6000], u=log.u[:6000], y=log.y[:6000], extra={})
    assert told(library, log) == []
    with pytest.raises(BadInput, match="u_V stands one row late in the log: moved by that, the plant follows"):
        told(library, logged(log, Misplaced((0,), 1)))
    with pytest.raises(BadInput, match="u_V stands one row early in the log, or the plant is so late"):
        told(library, logged(log, Misplaced((0,), -1)))


@pytest.mark.soak
def test_where_a_row_does_not_show_that_is_told_with_figures() -> None:
    """Truth: position in steps of 3 mrad at 5 ms, read after a delay that scatters: the plant's noise hides a row."""
    library, log = effect_library(bound("torque_limited_pendulum")), recorded("torque_limited_pendulum", "sac")
    case = make_case(library, [log])
    (note,) = demand_rows(case, plain_fit(case), "the log", (LATE, EARLY))
    assert note.kind == "rows_unseen"
    assert max(abs(note.numbers["up_nats"]), abs(note.numbers["down_nats"])) < 10.0


@pytest.mark.parametrize("effects", sampled(EFFECTS, keep=[]), ids=[next(iter(effects)) for effects in EFFECTS])
def test_a_plant_that_lacks_something_is_not_taken_for_commands_logged_late(
    stateless: EffectLibrary, fly: Fly, effects: dict[str, dict[str, float]]
) -> None:
    assert "columns_late" not in told(stateless, fly(32, effects, SECONDS))


def test_an_arm_that_lacks_its_friction_is_not_taken_for_commands_logged_late() -> None:
    assert "columns_late" not in told(effect_library(arm()), arm_log(RUB, seed=32, seconds=SECONDS))


@pytest.mark.parametrize(("effects", "promised"), [({}, False), ({"theta_sensor.backlash": {"width": 0.05}}, True)])
def test_an_effect_that_promises_more_than_a_move_of_columns_is_seen(effects, promised: bool) -> None:
    # Truth: a play of 3 degrees, which one column a row late could follow only in part; and a rig that lacks nothing.
    case = make_case(effect_library(arm()), [arm_log(effects, seed=7)])
    assert (most_by_an_effect(case, plain_fit(case)) > 2.0 * decisions.LOGS_DOUBTED) is promised


def test_of_a_move_that_an_effect_explains_better_nothing_is_said() -> None:
    # Truth: commands logged three rows early, by which the plant follows more than the 50 nats better that refuse a log; and the same from
    # a rig whose encoder has steps of two counts, which alone promise some 500 nats.
    early, ways = Misplaced((0,), -3), (LATE, EARLY)
    with pytest.raises(BadInput, match="u_V stands three rows early"):
        told(effect_library(arm()), logged(arm_log(seed=7), early), ways)
    coarse = arm_log({"theta_sensor.quantization": {"q": 0.0023}}, seed=7)
    assert told(effect_library(arm()), logged(coarse, early), ways) == []


def test_of_a_plant_without_an_input_nothing_is_said_of_its_commands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Truth: a free swing has one column, its angle, and nothing beside which that could stand late."""
    swing: Any = SimpleNamespace(bound=SimpleNamespace(model=SimpleNamespace(inputs=(), outputs={"theta_rad": None})))
    case: Any = SimpleNamespace(library=swing)
    usual: Any = SimpleNamespace(hypothesis=None)
    monkeypatch.setattr(rows, "looked_at", lambda case: case)
    monkeypatch.setattr(rows, "settled_or_none", lambda *_: usual)
    monkeypatch.setattr(rows, "with_usual_forces", lambda *_: usual)
    assert demand_rows(case, usual, "the log") == ()
