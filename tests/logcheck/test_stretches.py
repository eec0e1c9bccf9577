"""Logs made ready for a search: long ones by parts that hold their beginning, their end and where most moves; calendar times."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from logcheck import thresholds
from logcheck.stamps import from_their_start
from logcheck.stretches import stretches
from records.log import RunLog
from sim.columns import log_columns
from tests.plants import bound


def log_of(n: int) -> RunLog:
    """A log that hardly moves but for its part from 0.60 to 0.62 of its time."""
    t_s = 5.0 + 0.01 * np.arange(n)
    lively = 0.001 + ((np.arange(n) >= 0.60 * n) & (np.arange(n) < 0.62 * n))
    y = np.column_stack([lively * np.sin(3.0 * t_s), lively * np.cos(2.0 * t_s)])
    return RunLog(log_columns(bound("ce150").model), 0.01, "open", t_s, 0.1 * y, y, seq=np.arange(n))


def all_rows(log: RunLog) -> np.ndarray:
    return np.ones(len(log.t_s), bool)


def test_logs_that_a_search_can_hold_stay_whole() -> None:
    logs = [log_of(6000), log_of(6000)]
    found = stretches(logs, [all_rows(log) for log in logs], ["one", "two"])
    assert all(part is log for part, log in zip(found.logs, logs, strict=True))
    assert (found.names, found.notes) == (("one", "two"), ())


def test_a_million_rows_are_shown_by_their_beginning_their_end_and_where_most_moves() -> None:
    long, short = log_of(1_000_000), log_of(6000)
    used = [np.arange(1_000_000) % 3 > 0, all_rows(short)]
    found = stretches([long, short], used, ["long", "short"])
    assert found.logs[-1] is short
    readings = sum(log.y.size for log in found.logs)
    assert 0.8 * thresholds.MOST_READINGS < readings <= thresholds.MOST_READINGS
    parts = [log for log, name in zip(found.logs, found.names, strict=True) if name.startswith("long")]
    assert parts[0].t_s[0] == long.t_s[0]
    assert parts[-1].t_s[-1] == long.t_s[-1]
    assert sum(0.58e4 < log.t_s[0] < 0.63e4 for log in parts) >= 3
    for log, mask in zip(found.logs[: len(parts)], found.used, strict=False):
        rows = np.searchsorted(long.t_s, log.t_s)
        np.testing.assert_array_equal(long.y[rows], log.y)
        np.testing.assert_array_equal(used[0][rows], mask)
        assert log.seq is not None
        np.testing.assert_array_equal(log.seq, rows)
    assert all(earlier.t_s[-1] < later.t_s[0] for earlier, later in pairwise(parts))
    assert [note.subject for note in found.notes] == ["long"]
    assert "1000000 rows" in str(found.notes[0].said)


def test_rows_far_denser_than_a_plant_needs_are_thinned_and_all_of_the_log_is_seen() -> None:
    n, period_s = 500_000, 60e-6  # the short log leaves room for 11 500 rows: one in 44
    t_s = period_s * np.arange(n)
    y = np.column_stack([np.sin(t_s), np.cos(t_s)])
    dense = RunLog(log_columns(bound("ce150").model), period_s, "open", t_s, 0.1 * y, y, seq=np.arange(n))
    mask = np.arange(n) % 3 > 0
    found = stretches([dense, log_of(1000)], [mask, all_rows(log_of(1000))], ["dense", "short"])
    seen = found.logs[0]
    assert (found.names, len(seen.t_s)) == (("dense", "short"), -(-n // 44))
    assert seen.sample_period_s == pytest.approx(44 * period_s, rel=1e-4)
    rows = np.searchsorted(dense.t_s, seen.t_s)
    blocks = np.arange(0, n, 44)
    np.testing.assert_array_equal(rows, blocks + (blocks % 3 == 0))  # the first of each 44 that may be used
    assert found.used[0].all()
    np.testing.assert_array_equal(seen.y, y[rows])
    assert seen.u[7] == pytest.approx(0.1 * y[rows[7] : rows[8]].mean(axis=0))
    assert seen.seq is None
    assert tuple(note.said for note in found.notes) == (
        "dense: 11364 of its 500000 rows were looked at, spread evenly, as they are 60 microseconds apart",
    )


def test_a_long_dense_log_is_thinned_to_what_a_plant_needs_and_shown_by_stretches_of_all_of_it() -> None:
    n, period_s = 3_000_000, 100e-6
    t_s = period_s * np.arange(n)
    y = np.column_stack([np.sin(t_s), np.cos(t_s)])
    dense = RunLog(log_columns(bound("ce150").model), period_s, "open", t_s, 0.1 * y, y)
    found = stretches([dense], [all_rows(dense)], ["dense"])
    # 12 500 rows of 4 ms are 50 s, which is five stretches of ten seconds and more.
    assert len(found.logs) == 5
    assert [log.sample_period_s for log in found.logs] == pytest.approx([0.004] * 5, rel=1e-4)
    assert found.logs[0].t_s[0] == 0.0
    assert found.logs[-1].t_s[-1] == pytest.approx(t_s[-1], abs=0.02)
    assert "as 5 stretches" in str(found.notes[1].said)


def test_a_log_with_an_output_that_was_never_measured_is_cut_without_warnings(recwarn: pytest.WarningsRecorder) -> None:
    log = log_of(60_000)
    log.y[:, 0] = np.nan
    assert len(stretches([log], [all_rows(log)], ["log"]).logs) == 8
    assert not [str(warning.message) for warning in recwarn]


def test_a_single_stretch_is_called_one() -> None:
    logs = [log_of(6000) for _ in range(20)]
    found = stretches(logs, [all_rows(log) for log in logs], [str(index) for index in range(20)])
    assert all("as 1 stretch: " in str(note.said) for note in found.notes)


def test_many_logs_share_alike_and_none_is_torn_to_pieces() -> None:
    logs = [log_of(6000) for _ in range(12)]
    found = stretches(logs, [all_rows(log) for log in logs], [str(index) for index in range(12)])
    assert sum(log.y.size for log in found.logs) <= thresholds.MOST_READINGS
    assert len(found.logs) == 12
    assert {len(log.t_s) for log in found.logs} <= {1041, 1042}  # 25 000 readings of two outputs, in twelve


def test_times_of_a_calendar_count_from_the_run_s_start_and_others_stay() -> None:
    log = log_of(100)
    dated = replace(log, t_s=log.t_s + 1.7e9)
    (same, moved), notes = from_their_start([log, dated], ["one", "two"])
    assert same is log
    assert moved.t_s == pytest.approx(log.t_s - log.t_s[0], abs=1e-6)
    assert [note.subject for note in notes] == ["two"]
    assert "1700000005 s" in str(notes[0].said)
