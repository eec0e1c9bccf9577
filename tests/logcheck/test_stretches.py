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

SLOW_RAD_S = 3.0  # of a plant that needs no row closer than COARSEST_S


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
    found = stretches(logs, [all_rows(log) for log in logs], ["one", "two"], SLOW_RAD_S)
    assert all(part is log for part, log in zip(found.logs, logs, strict=True))
    assert (found.names, found.notes) == (("one", "two"), ())


def test_of_no_logs_nothing_is_looked_at() -> None:
    assert stretches([], [], [], SLOW_RAD_S).logs == ()


def test_a_million_rows_are_shown_by_their_beginning_their_end_and_where_most_moves() -> None:
    long, short = log_of(1_000_000), log_of(6000)
    used = [np.arange(1_000_000) % 3 > 0, all_rows(short)]
    found = stretches([long, short], used, ["long", "short"], SLOW_RAD_S)
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


def dense_log(n: int, period_s: float) -> RunLog:
    t_s = period_s * np.arange(n)
    y = np.column_stack([np.sin(t_s), np.cos(t_s)])
    return RunLog(log_columns(bound("ce150").model), period_s, "open", t_s, 0.1 * y, y, seq=np.arange(n))


def test_rows_denser_than_a_plant_needs_are_thinned_and_all_of_the_log_is_seen() -> None:
    n, period_s, factor = 500_000, 60e-6, 125  # by 166 rows were 10 ms apart, by 125 4000 are left
    dense, mask = dense_log(n, period_s), np.arange(n) % 3 > 0
    found = stretches([dense, log_of(1000)], [mask, all_rows(log_of(1000))], ["dense", "short"], SLOW_RAD_S)
    seen = found.logs[0]
    assert (found.names, len(seen.t_s)) == (("dense", "short"), -(-n // factor))
    assert seen.sample_period_s == pytest.approx(factor * period_s, rel=1e-4)
    rows = np.searchsorted(dense.t_s, seen.t_s)
    blocks = np.arange(0, n, factor)
    np.testing.assert_array_equal(rows, blocks + (mask[blocks] == 0))  # the first of each 125 that may be used
    assert found.used[0].all()
    np.testing.assert_array_equal(seen.y, dense.y[rows])
    assert seen.u[7] == pytest.approx(0.1 * dense.y[rows[7] : rows[8]].mean(axis=0))
    assert seen.seq is None
    assert tuple(note.said for note in found.notes) == (
        "dense: 4000 of its 500000 rows were looked at, spread evenly, as they are 60 microseconds apart",
    )


def test_a_fast_plant_keeps_four_rows_for_each_of_its_shortest_time_constant() -> None:
    dense = dense_log(20_000, 1e-3)
    found = stretches([dense], [all_rows(dense)], ["dense"], 125.0)  # 8 ms, a quarter of it 2 ms
    assert found.logs[0].sample_period_s == pytest.approx(2e-3, rel=1e-4)


def test_of_a_recording_and_its_every_second_row_the_same_rows_are_seen() -> None:
    dense = dense_log(50_000, 1e-3)
    half = replace(
        dense,
        sample_period_s=2e-3,
        t_s=dense.t_s[::2],
        y=dense.y[::2],
        u=dense.u.reshape(-1, 2, 2).mean(axis=1),
        seq=None,
    )
    whole, halved = (stretches([log], [all_rows(log)], ["log"], SLOW_RAD_S).logs[0] for log in (dense, half))
    np.testing.assert_array_equal(whole.t_s, halved.t_s)
    np.testing.assert_array_equal(whole.y, halved.y)
    np.testing.assert_allclose(whole.u, halved.u, rtol=1e-12)


def test_of_short_logs_every_row_is_seen_however_dense() -> None:
    dense = dense_log(thresholds.ENOUGH_ROWS, 1e-3)
    assert stretches([dense], [all_rows(dense)], ["dense"], SLOW_RAD_S).logs == (dense,)


def test_a_long_dense_log_is_thinned_to_what_a_plant_needs_and_shown_by_stretches_of_all_of_it() -> None:
    dense = dense_log(3_000_000, 100e-6)
    found = stretches([dense], [all_rows(dense)], ["dense"], SLOW_RAD_S)
    # 12 500 rows of 10 ms are 125 s, which is eight stretches of more than ten seconds.
    assert len(found.logs) == 8
    assert [log.sample_period_s for log in found.logs] == pytest.approx([0.01] * 8, rel=1e-4)
    assert found.logs[0].t_s[0] == 0.0
    assert found.logs[-1].t_s[-1] == pytest.approx(dense.t_s[-1], abs=0.02)
    assert "as 8 stretches" in str(found.notes[1].said)


def test_a_log_with_an_output_that_was_never_measured_is_cut_without_warnings(recwarn: pytest.WarningsRecorder) -> None:
    log = log_of(60_000)
    log.y[:, 0] = np.nan
    assert len(stretches([log], [all_rows(log)], ["log"], SLOW_RAD_S).logs) == 8
    assert not [str(warning.message) for warning in recwarn]


def test_a_single_stretch_is_called_one() -> None:
    logs = [log_of(6000) for _ in range(20)]
    found = stretches(logs, [all_rows(log) for log in logs], [str(index) for index in range(20)], SLOW_RAD_S)
    assert all("as 1 stretch: " in str(note.said) for note in found.notes)


def test_many_logs_share_alike_and_none_is_torn_to_pieces() -> None:
    logs = [log_of(6000) for _ in range(12)]
    found = stretches(logs, [all_rows(log) for log in logs], [str(index) for index in range(12)], SLOW_RAD_S)
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
