"""A log that lacks rows, readings or digits: the firmware is cleared in what is there, and one that is at fault is not."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from design.law import FloatLaw
from records.log import RunLog, load_log
from records.table import load_table
from replay.causes.printed import agrees_as_printed
from replay.digits import printing
from replay.flight import flight_of
from replay.stretches import replay_stretches
from sim.bind import bind
from sim.columns import log_columns
from sim.loop import fly, fly_law
from tests.law_tables import ce150_table, changed_axis
from tests.replay.firmware_flights import (
    Inputs,
    Lossy,
    Wrapped,
    default_flight,
    flown,
    lively,
    own,
    plant,
    rows_of,
    stale,
)
from tests.soak import sampled
from verification.host_law import host_law

TABLE = ce150_table()


def printed(log: RunLog, digits: int) -> RunLog:
    """The log as text of so many significant digits has it."""

    def read(values: np.ndarray) -> np.ndarray:
        return np.array([float(f"{value:.{digits}g}") for value in values.ravel()]).reshape(values.shape)

    return replace(log, u=read(log.u), y=read(log.y), extra={name: read(values) for name, values in log.extra.items()})


@pytest.mark.parametrize("digits", [3, 5, 7, 8])
def test_a_log_of_few_digits_clears_the_firmware_and_asks_for_nine(digits: int) -> None:
    found = replay_stretches(printed(own(), digits), TABLE)
    assert (found.bit_exact, found.cause) == (False, "log_rounding")
    assert "print nine digits" in (found.sentence or "")


def test_a_firmware_at_fault_is_not_taken_for_rounding() -> None:
    log = own()
    stale = replace(log, y=np.concatenate([log.y[1:], log.y[-1:]]))  # the law used the angles of the sample before
    assert agrees_as_printed(flight_of(printed(stale, 5), TABLE), TABLE) is None


def test_what_rounding_may_do_to_the_answers_is_rounding() -> None:
    log = printed(own(), 6)
    assert agrees_as_printed(flight_of(own(), TABLE), TABLE) is None  # nothing was rounded
    within_V = agrees_as_printed(flight_of(log, TABLE), TABLE)
    assert within_V is not None
    assert within_V < 0.01


def test_digits_are_those_that_round_a_column_most() -> None:
    values = np.random.default_rng(1).uniform(-0.5, 0.5, 500)
    assert str(printing([float(f"{value:.4g}") for value in values])) == "4 significant digits"
    assert str(printing(np.round(values, 4))) == "4 decimals"


def test_behind_lost_rows_the_law_goes_on_from_what_the_log_tells() -> None:
    log = default_flight()
    t_s = log.t_s - log.t_s[0]
    found = replay_stretches(rows_of(log, (t_s < 10.0) | (t_s > 11.0)), TABLE)
    assert (found.bit_exact, found.cause) == (False, "missing_rows")
    assert "the firmware is cleared, from " in (found.sentence or "")
    assert "it agrees within" in (found.sentence or "")


def test_what_is_told_of_the_state_is_told_anew_before_its_rounding_has_grown(ran: tuple[Path, str]) -> None:
    # Truth: the flight of the table's own law, of which 2 s were lost. What the log tells of its state 20 s later is within 0.1 mV for
    # under a minute of the 85 s behind.
    table = load_table(ran[0] / "controller.json")
    log = load_log(ran[0] / "run.csv", log_columns(plant().model))
    t_s = log.t_s - log.t_s[0]
    found = replay_stretches(rows_of(log, (t_s < 7.0) | (t_s >= 9.0)), table)
    assert (found.bit_exact, found.cause) == (False, "missing_rows")
    assert f"to {t_s[-1]:g} s it agrees within 0.0001 V" in (found.sentence or "")


def test_single_cells_that_are_empty_are_readings_that_the_log_lacks() -> None:
    log = own()
    y = log.y.copy()
    hidden = np.random.default_rng(2).random(len(y)) < 0.1
    y[hidden, 0] = np.nan
    found = replay_stretches(replace(log, y=y), TABLE)
    assert (found.bit_exact, found.cause) == (False, "sample_not_logged")
    said = f"the log lacks {hidden.sum()} samples that the firmware had, first at {log.t_s[hidden][0]:.6g} s"
    assert said in (found.sentence or "")
    assert "the firmware is cleared" in (found.sentence or "")


def test_a_second_recording_in_the_file_is_replayed_from_rest() -> None:
    log = own()
    twice = replace(
        log,
        t_s=np.concatenate([log.t_s, log.t_s + log.t_s[-1] + 0.01]),
        u=np.tile(log.u, (2, 1)),
        y=np.tile(log.y, (2, 1)),
        extra={name: np.tile(values, 2) for name, values in log.extra.items()},
    )
    begins = np.arange(len(twice.t_s)) == len(log.t_s)
    sentence = replay_stretches(twice, TABLE, begins=begins).sentence or ""
    assert "it agrees to the bit" in sentence
    assert sentence.startswith("another recording begins behind")


def test_a_law_that_flew_in_double_precision_by_its_log_is_run_again_in_it() -> None:
    log = fly_law(plant(), TABLE, lively())
    assert log.arithmetic == "float64"
    found = replay_stretches(log, TABLE)
    assert (found.first_difference_s, found.cause) == (None, "flown_in_double")
    assert not found.record().differs
    unsaid = replay_stretches(replace(log, arithmetic=None), TABLE)  # a firmware that computes so is not its table's
    assert (unsaid.cause, unsaid.record().differs) == ("float64", True)


def test_what_else_is_amiss_with_a_flight_in_double_precision_is_still_told() -> None:
    log = fly_law(plant(), TABLE, lively())
    late = replace(log, y=np.concatenate([log.y[1:], log.y[-1:]]))
    found = replay_stretches(late, TABLE)
    assert "stale_sample" in (found.cause or "")
    assert "double" not in (found.sentence or "")


@pytest.mark.parametrize("decimals", [None, 3])
def test_the_steps_of_a_sensor_are_no_rounding_of_the_log(decimals: int | None) -> None:
    """Steps of 1 mrad have three decimals, as text too: a firmware that computes otherwise is not cleared by them."""
    bound = bind(replace(plant().plant, sensors={"psi_rad": 1e-3, "phi_rad": 1e-3}))
    table = changed_axis(changed_axis(TABLE, "elevation", resolution_rad=1e-3), "azimuth", resolution_rad=1e-3)
    for law, cause in ((host_law(table), None), (FloatLaw(table), "float64")):
        log = fly(bound, law, lively(), table_digest=table.digest)
        log = log if decimals is None else replace(log, y=np.round(log.y, decimals))
        found = replay_stretches(log, table)
        assert found.cause == cause
        assert found.bit_exact == (cause is None)


@pytest.mark.usefixtures("one_change")
def test_zeros_written_for_readings_that_were_not_there_are_none_also_beside_zero() -> None:
    """Far from zero the check of the log leaves them out; a step or two beside it nobody sees them but the law."""
    log = own()
    far = np.flatnonzero(np.abs(log.y[:, 1]) > 0.1)[5::97]
    near = np.flatnonzero((log.y[:, 1] != 0.0) & (np.abs(log.y[:, 1]) < 5e-3))[3::7]
    assert far.size > 5
    assert near.size > 5
    y = log.y.copy()
    y[far, 1], y[near, 1] = np.nan, 0.0
    found = replay_stretches(replace(log, y=y), TABLE)
    assert (found.bit_exact, found.cause) == (False, "sample_not_logged")
    y[far, 1] = log.y[far, 1]  # where no reading is missing a zero is a zero
    assert replay_stretches(replace(log, y=y), TABLE).cause != "sample_not_logged"


@pytest.mark.usefixtures("one_change")
def test_a_sensor_that_stands_in_the_log_alone_is_told_with_its_times_and_nobody_is_accused() -> None:
    log = rows_of(default_flight(), np.arange(4500))
    rows = slice(2500, 2700)
    y = log.y.copy()
    y[rows, 0] = y[rows.start, 0]
    found = replay_stretches(replace(log, y=y), TABLE)
    assert np.ptp(log.y[rows, 0]) > 0.0
    assert found.cause == "missing_rows"
    assert "psi_rad stands from 25" in (found.sentence or "")
    assert "psi_rad stands" in (found.sentence or "")
    assert not found.record().differs


@pytest.mark.usefixtures("one_change")
def test_a_firmware_that_went_wrong_in_a_hold_is_not_cleared_by_it() -> None:
    """Noise on the law's answer from a hold on: the readings stand, and what follows is no answer of the law either."""
    log = rows_of(default_flight(), np.arange(3200))
    u = log.u.copy()
    u[2500:, 0] += np.random.default_rng(4).normal(0.0, 0.01, len(u) - 2500)
    found = replay_stretches(replace(log, u=u), TABLE)
    assert found.cause == "not_found"
    assert found.record().differs


LOST = ["angles", "reference", "an angle, and the other stands"]


@pytest.mark.usefixtures("one_change")
@pytest.mark.parametrize("lost", sampled(LOST, keep=LOST[1:]))
def test_readings_that_are_missing_to_the_end_are_the_logs_doing(lost: str) -> None:
    """Truth: the table's own law flew to the end; from 12 s on the log lacks what it took."""
    log = own()
    gone = log.t_s >= 12.0
    if lost == "reference":
        reference = log.extra["psi_ref_rad"]
        log = replace(log, extra={**log.extra, "psi_ref_rad": np.where(gone, np.nan, reference)})
    else:
        which = [True, lost == "angles"]
        log = replace(log, y=np.where(gone[:, None] & which, np.nan, log.y))
    if lost == "an angle, and the other stands":
        stands = log.y.copy()
        stands[log.t_s >= 15.0, 1] = log.y[log.t_s >= 15.0, 1][0]  # frozen besides
        log = replace(log, y=stands)
    found = replay_stretches(log, TABLE)
    assert (found.bit_exact, found.cause) == (False, "missing_rows")
    assert found.sentence == "readings are missing behind 11.99 s; up to there the firmware is cleared"


@pytest.mark.usefixtures("one_change")
def test_a_firmware_at_fault_before_readings_are_missing_to_the_end_is_found() -> None:
    log = own()
    u, y = log.u.copy(), log.y.copy()
    u[500] = u[499]
    y[1500:] = np.nan
    assert replay_stretches(replace(log, u=u, y=y), TABLE).record().differs


@pytest.mark.usefixtures("one_change")
def test_a_log_cut_where_the_law_rested_begins_in_flight() -> None:
    """Truth: the table's own law, which held both references for seconds before and behind the cut, so that from rest it is little off."""
    log = default_flight(5.0)
    assert np.ptp(log.y[:100], axis=0).max() < 0.01
    found = replay_stretches(log, TABLE)
    assert (found.bit_exact, found.cause) == (False, "begins_in_flight")


@pytest.mark.parametrize("share", [0.005, 0.025, 0.05])
def test_a_log_that_repeats_single_readings_of_a_slow_axis_clears_the_firmware(share: float) -> None:
    """Truth: the law of the table flew; random rows of the log repeat the elevation's reading before, where it moved by three counts at
    most."""
    log = own()
    counts = np.round(log.y[:, 0] / TABLE.axes[0].resolution_rad)
    moved = np.append(False, np.abs(np.diff(counts)) > 0) & (np.append(0, np.abs(np.diff(counts))) <= 3)
    kept = np.flatnonzero((np.random.default_rng(7).random(len(counts)) < share) & (np.arange(len(counts)) > 0))
    kept = kept[np.abs(counts[kept] - counts[kept - 1]) <= 3]
    assert moved[kept].any()
    y = log.y.copy()
    y[kept, 0] = log.y[kept - 1, 0]
    found = replay_stretches(replace(log, y=y), TABLE)
    rows = moved[kept].sum()
    assert (found.bit_exact, found.cause) == (False, "reading_not_as_logged")
    assert not found.record().differs
    said = f"in {rows} rows" if rows > 1 else "in a row"
    assert f"the log holds another reading than the firmware had {said}" in (found.sentence or "")


@pytest.mark.parametrize(("counts", "axes"), [(2, [0]), (5, [0]), (5, [1]), (5, [0, 1]), (20, [0])])
def test_readings_that_leap_and_come_back_are_the_logs_and_no_stale_samples(counts: int, axes: list[int]) -> None:
    """Truth: the law of the table flew; in 3 % of the rows, at rest too, the log holds readings so many counts off, some side by side."""
    log, rng = own(), np.random.default_rng(12)
    rows = 1 + np.flatnonzero(rng.random(len(log.t_s) - 2) < 0.03)
    assert (np.diff(rows) == 1).any()
    y = log.y.copy()
    for axis in axes:
        y[rows, axis] += rng.choice([-counts, counts], len(rows)) * TABLE.axes[axis].resolution_rad
    y = np.round(y / TABLE.axes[0].resolution_rad) * TABLE.axes[0].resolution_rad
    found = replay_stretches(replace(log, y=y), TABLE)
    assert (found.bit_exact, found.cause) == (False, "reading_not_as_logged")
    assert not found.record().differs
    assert {at_s for _, at_s in found.incidents} <= set(log.t_s[rows].tolist())
    assert f"in {len(rows)} rows" in (found.sentence or "")


@pytest.mark.usefixtures("one_change")
@pytest.mark.parametrize("columns", [[2, 3], [2]])
def test_a_firmware_that_used_an_older_reading_is_not_cleared_by_the_log(columns: list[int]) -> None:
    """Truth: in 2 % of the samples the law had angles of the sample before, and the log the right ones."""
    chosen = np.random.default_rng(8).random(2001) < 0.02

    def before(k: int, given: Sequence[Inputs]) -> Inputs:
        return stale(columns)(k, given) if chosen[k] else given[k]

    found = replay_stretches(flown(Wrapped(host_law(TABLE), before)), TABLE)
    assert found.cause is not None
    assert found.record().differs


def test_readings_that_repeat_beside_others_that_the_log_lacks_clear_the_firmware_too() -> None:
    """Truth: 4 % of the elevation's readings repeat the one before, and 4 % of the azimuth's are empty, some in the same rows."""
    log, rng = own(), np.random.default_rng(11)
    y = log.y.copy()
    kept, lost = (1 + np.flatnonzero(rng.random(len(y) - 1) < 0.04) for _ in range(2))
    y[kept, 0] = log.y[kept - 1, 0]
    y[lost, 1] = np.nan
    assert np.intersect1d(kept, lost).size
    found = replay_stretches(replace(log, y=y), TABLE)
    assert found.cause == "reading_not_as_logged"
    assert "the firmware is cleared" in (found.sentence or "")


@pytest.mark.usefixtures("one_change")
@pytest.mark.parametrize("share", [0.005, 0.05])
def test_so_it_does_where_the_law_computes_in_fixed_point(share: float) -> None:
    """Truth: the same in integers; behind a reading that is another all words differ."""
    log = flown(host_law(TABLE, "fixed"))
    kept = 1 + np.flatnonzero(np.random.default_rng(7).random(len(log.t_s) - 1) < share)
    y = log.y.copy()
    y[kept] = log.y[kept - 1]
    rows = np.flatnonzero((y != log.y).any(axis=1))
    found = replay_stretches(replace(log, y=y), TABLE)
    assert (found.bit_exact, found.cause) == (False, "reading_not_as_logged")
    assert [at_s for _, at_s in found.incidents] == log.t_s[rows].tolist()
    assert "in fixed point" in (found.sentence or "")


@pytest.mark.usefixtures("one_change")
def test_a_law_in_fixed_point_that_lost_samples_is_not_cleared_by_readings() -> None:
    """Truth: in 1 % of the samples the law was not run and its output stayed."""
    lost = np.random.default_rng(9).random(2001) < 0.01
    log = flown(Lossy(host_law(TABLE, "fixed"), lambda k: "law" if lost[k] else None))
    assert replay_stretches(log, TABLE).record().differs
