"""What `verify --log` says of a log whose inputs are not the law's at their rows."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from logcheck.integrity import Integrity
from records.errors import BadInput
from records.log import RunLog, save_log
from tests.law_tables import ce150_table
from tests.replay.firmware_flights import Wrapped, default_flight, flown, own, plant, rows_of
from tests.soak import sampled
from twinlaw.workflows.chain import verifying
from twinlaw.workflows.chain.verifying import recorded_replay
from verification.host_law import host_law

Array = NDArray[np.float64]

pytestmark = pytest.mark.usefixtures("one_change")


def test_a_log_is_compared_and_what_explains_its_difference_is_said(tmp_path: Path) -> None:
    save_log(tmp_path / "own.csv", own())
    replay, said = recorded_replay(tmp_path / "own.csv", ce150_table(), plant())
    assert (replay.sent is not None, said) == (True, ())
    for name, sent, told in (("both", late, "its output"), ("one", late_main, "u_M_V")):
        save_log(tmp_path / f"{name}.csv", flown(Wrapped(host_law(ce150_table()), after=sent)))
        replay, said = recorded_replay(tmp_path / f"{name}.csv", ce150_table(), plant())
        assert replay.sent is not None
        assert said == (f"{name}.csv: the firmware sent {told} one sample late, or the log has it so",)


@cache
def flown_late() -> RunLog:
    """The lively flight of such a firmware."""
    return flown(Wrapped(host_law(ce150_table()), after=late))


def late(k: int, sent: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """A firmware whose answers reach the rig a sample late."""
    return sent[max(0, k - 1)]


def late_main(k: int, sent: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """The same of the main rotor alone."""
    return sent[max(0, k - 1)][0], sent[k][1]


LOGGED = [
    ("both_late", lambda log: replace(log, u=shifted(log.u, [0, 1], 1)), "u_M_V and u_T_V stand one row late"),
    ("main_late", lambda log: replace(log, u=shifted(log.u, [0], 1)), "u_M_V stands one row late"),
    ("tail_early", lambda log: replace(log, u=shifted(log.u, [1], -1)), "would have sent u_T_V one sample before"),
    ("psi_early", lambda log: replace(log, y=shifted(log.y, [0], -1)), "psi_rad stands one row early"),
    ("phi_late", lambda log: replace(log, y=shifted(log.y, [1], 1)), "the azimuth that the log holds one sample too"),
    ("tail_turned", lambda log: replace(log, u=log.u * [1.0, -1.0]), "u_T_V has the wrong sign"),
    ("exchanged", lambda log: replace(log, y=log.y[:, ::-1].copy()), "psi_rad and phi_rad stand in each other's place"),
]


@pytest.mark.parametrize(("name", "wrong", "told"), sampled(LOGGED, keep=[LOGGED[n] for n in (1, 4, 6)]))
def test_a_log_whose_columns_the_plant_denies_fails_no_verification(
    name: str, wrong: Callable[[RunLog], RunLog], told: str, tmp_path: Path
) -> None:
    """Truth: the firmware did as its table says, and the log holds columns in other rows, with another sign, or in another's place."""
    save_log(tmp_path / f"{name}.csv", wrong(own()))
    with pytest.raises(BadInput, match=told):
        recorded_replay(tmp_path / f"{name}.csv", ce150_table(), plant())


def shifted(values: Array, columns: Sequence[int], rows: int) -> Array:
    """The same with some columns so many rows late."""
    moved, source = values.copy(), np.clip(np.arange(len(values)) - rows, 0, len(values) - 1)
    moved[:, columns] = values[source][:, columns]
    return moved


def test_references_that_the_log_holds_too_late_fail_no_verification(tmp_path: Path) -> None:
    """Truth: the azimuth's reference is logged two rows behind that in which the law had it, which no firmware can bring about."""
    rows = np.clip(np.arange(len(own().t_s)) - 2, 0, None)
    moved = {**own().extra, "phi_ref_rad": own().extra["phi_ref_rad"][rows]}
    save_log(tmp_path / "late.csv", replace(own(), extra=moved))
    replay, said = recorded_replay(tmp_path / "late.csv", ce150_table(), plant())
    assert replay.sent is None
    assert "used the azimuth reference that the log holds 2 samples too late" in said[0]


def test_a_last_row_that_was_written_in_part_is_told_and_the_others_are_compared(tmp_path: Path) -> None:
    save_log(tmp_path / "own.csv", own())
    whole = (tmp_path / "own.csv").read_text().rstrip("\n")
    (tmp_path / "own.csv").write_text(whole.rsplit(",", 3)[0])
    replay, said = recorded_replay(tmp_path / "own.csv", ce150_table(), plant())
    assert replay.sent is not None
    assert len(replay.sent) == len(own().t_s) - 1
    assert said[0].startswith(f"own.csv: line {len(own().t_s) + 1}, the last, was not written to its end")


def test_every_fourth_row_is_not_laid_on_the_firmware_whatever_period_the_sidecar_states(tmp_path: Path) -> None:
    """Truth: the flight of the table's own law at 10 ms; the sidecar states the 40 ms of the rows that were kept."""
    log = rows_of(own(), np.arange(len(own().t_s)) % 4 == 0)
    save_log(tmp_path / "fourth.csv", replace(log, sample_period_s=0.04))
    replay, said = recorded_replay(tmp_path / "fourth.csv", ce150_table(), plant())
    assert replay.sent is None
    assert said[0].startswith("fourth.csv: the log holds ")
    assert "samples; the law's state between them cannot be known" in said[0]


def test_a_log_whose_columns_are_wrong_is_refused_and_not_laid_on_the_firmware(tmp_path: Path) -> None:
    """Truth: the commands a row early, and from row 1000 on the other sign of phi; both are the log's."""
    early = replace(own(), u=np.concatenate([own().u[1:], own().u[-1:]]))
    save_log(tmp_path / "early.csv", early)
    with pytest.raises(BadInput, match="commands in rows before those of the angles that they answer"):
        recorded_replay(tmp_path / "early.csv", ce150_table(), plant())
    turned = own().y.copy()
    at = int(np.argmax(np.abs(turned[500:1500, 1] * np.diff(turned[499:1500, 1])))) + 500  # far out and under way
    turned[at:, 1] *= -1.0
    save_log(tmp_path / "turned.csv", replace(own(), y=turned))
    with pytest.raises(BadInput, match=f"the sign of phi_rad turns at {own().t_s[at]:g} s"):
        recorded_replay(tmp_path / "turned.csv", ce150_table(), plant())


def test_a_log_of_a_plant_that_nobody_knows_is_told_with_the_plant_that_was_given(tmp_path: Path) -> None:
    save_log(tmp_path / "own.csv", replace(own(), columns=replace(own().columns, plant="tank")))
    with pytest.raises(BadInput, match="plant: got 'tank', expected 'ce150'; give the log and the plant of one rig"):
        recorded_replay(tmp_path / "own.csv", ce150_table(), plant())


def test_readings_of_zero_that_the_log_check_leaves_out_are_not_laid_on_the_firmware(tmp_path: Path) -> None:
    log = own()
    y = log.y.copy()
    y[np.random.default_rng(2).random(len(y)) < 0.03, 1] = 0.0
    save_log(tmp_path / "zeros.csv", replace(log, y=y))
    replay, said = recorded_replay(tmp_path / "zeros.csv", ce150_table(), plant())
    assert replay.sent is None
    assert "the firmware is cleared" in " ".join(said)


def test_commands_of_zero_now_and_then_are_not_laid_on_the_firmware(tmp_path: Path) -> None:
    """Truth: the flight of the table's own law; in 1.5 % of the rows the log holds 0 for one of its commands, or for a reading too."""
    lost = np.random.default_rng(4).random((2, len(own().t_s))) < 0.015
    u, y = own().u.copy(), own().y.copy()
    u[lost[0], 0] = 0.0
    save_log(tmp_path / "u.csv", replace(own(), u=u))
    replay, said = recorded_replay(tmp_path / "u.csv", ce150_table(), plant())
    assert replay.sent is None
    assert said[0].startswith(f"u.csv: the log lacks what was sent in {lost[0].sum()} rows, first at ")
    assert "in all others every bit agrees" in said[0]
    y[lost[1], 1] = 0.0
    save_log(tmp_path / "both.csv", replace(own(), u=u, y=y))
    replay, said = recorded_replay(tmp_path / "both.csv", ce150_table(), plant())
    assert replay.sent is None
    assert "the firmware is cleared" in said[0]


LACKING = [(angles, share) for angles in ([0], [1], [0, 1]) for share in (0.01, 0.03)]


@pytest.mark.parametrize(("angles", "share"), sampled(LACKING, keep=[([1], 0.01), ([0, 1], 0.03)]))
def test_rows_that_lack_a_command_and_a_reading_too_are_not_laid_on_the_firmware(
    angles: list[int], share: float, tmp_path: Path
) -> None:
    """Truth: the flight of the table's own law; in some rows, two of them side by side here and there, both commands are zero and some
    angles were not read."""
    lost = np.random.default_rng(3).random(len(own().t_s)) < share
    u, y = own().u.copy(), own().y.copy()
    u[lost] = 0.0
    y[np.ix_(lost, angles)] = np.nan
    save_log(tmp_path / "lost.csv", replace(own(), u=u, y=y))
    replay, said = recorded_replay(tmp_path / "lost.csv", ce150_table(), plant())
    assert replay.sent is None
    assert "the firmware is cleared" in said[0] or "in all others every bit agrees" in said[0]
    save_log(tmp_path / "late.csv", replace(flown_late(), u=np.where(lost[:, None], 0.0, flown_late().u)))
    replay, said = recorded_replay(tmp_path / "late.csv", ce150_table(), plant())
    assert replay.sent is not None
    assert "the firmware sent its output one sample late" in said[0]


def test_a_firmware_at_fault_behind_commands_of_zero_is_still_told(tmp_path: Path) -> None:
    """Truth: the law's output came one sample late, and the log lacks some of it."""
    u = flown_late().u.copy()
    u[np.random.default_rng(4).random(len(u)) < 0.015, 0] = 0.0
    save_log(tmp_path / "late.csv", replace(flown_late(), u=u))
    replay, said = recorded_replay(tmp_path / "late.csv", ce150_table(), plant())
    assert replay.sent is not None
    assert said[0].startswith("late.csv: the firmware sent its output one sample late")


FIRST = [
    ("psi_rad", 1, np.nan, "the log lacks a sample that the firmware had, first at 0 s"),
    ("psi_rad", 1, 0.05, "the firmware is cleared"),
    ("phi_rad", 3, 0.3, "phi_rad is 0.3 in the first 3 rows, where the law had another value"),
    ("psi_ref_rad", 1, 0.25, "psi_ref_rad is 0.25 in the first row, where the law had another value"),
]


@pytest.mark.parametrize(("column", "rows", "value", "told"), sampled(FIRST, [FIRST[0], FIRST[3]]))
def test_a_wrong_first_value_that_the_law_did_not_have_fails_no_verification(
    column: str, rows: int, value: float, told: str, tmp_path: Path
) -> None:
    """Truth: the law's commands are the log's, and one of its angles or references is wrong in the first rows."""
    save_log(tmp_path / "wrong.csv", begun_with(column, rows, value))
    replay, said = recorded_replay(tmp_path / "wrong.csv", ce150_table(), plant())
    assert replay.sent is None
    assert told in " ".join(said)


def test_a_wrong_first_command_fails_the_verification(tmp_path: Path) -> None:
    save_log(tmp_path / "wrong.csv", begun_with("u_M_V", 1, 3.0))
    assert recorded_replay(tmp_path / "wrong.csv", ce150_table(), plant())[0].sent is not None


def begun_with(column: str, rows: int, value: float) -> RunLog:
    """An own flight whose column begins with another value."""
    log = own()
    log = replace(log, u=log.u.copy(), y=log.y.copy(), extra={name: v.copy() for name, v in log.extra.items()})
    log.column(column)[:rows] = value
    return log


def test_a_log_that_begins_in_flight_fails_no_verification(tmp_path: Path) -> None:
    """Truth: the table's own law flew, and the log was cut behind its first 20 s: nobody knows the law's state there to the bit."""
    save_log(tmp_path / "cut.csv", default_flight(20.0))
    replay, said = recorded_replay(tmp_path / "cut.csv", ce150_table(), plant())
    assert replay.sent is None
    assert "the log does not begin with the law at rest" in said[0]


def test_spikes_that_the_log_check_takes_for_others_are_not_laid_on_the_firmware(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Truth: phi was read 5 counts off in 3 % of the rows, in three of four at one place; the true reading between them is left out for
    two of these."""
    log, k = rows_of(own(), np.arange(len(own().t_s)) < 900), 500
    y = log.y.copy()
    off = np.zeros(y.shape)
    off[:, 1] = (np.random.default_rng(1).random(len(y)) < 0.03) * 5.0
    off[k - 8 : k + 12, 1] = 0.0
    off[k : k + 4, 1] = (5.0, 5.0, 0.0, -5.0)
    y += plant().plant.sensors["phi_rad"] * off
    unread = off != 0.0
    unread[k : k + 4, 1] = (False, False, True, True)
    save_log(tmp_path / "spikes.csv", replace(log, y=y))
    examine = verifying.examine

    def mistaken(*asked: Any, **how: Any) -> Integrity:
        found = examine(*asked, **how)
        return replace(found, logs=(replace(found.logs[0], unread=unread),))

    monkeypatch.setattr(verifying, "examine", mistaken)
    replay, said = recorded_replay(tmp_path / "spikes.csv", ce150_table(), plant())
    assert replay.sent is None
    assert "the firmware is cleared" in said[0]
