"""A log as its stretches: where rows are missing it ends, and what follows is another one; rows at random times are no breaks."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from logcheck.breaks import break_findings, gaps, unbroken
from logcheck.integrity import examine
from logcheck.zeros import zero_findings
from records.errors import BadInput
from records.log import RunLog, load_log, save_log
from tests.logcheck.test_parts import PLANT, STEP_RAD, log_of, rounded
from tests.replay.firmware_flights import rows_of


def lost(log: RunLog, *spans: tuple[int, int]) -> RunLog:
    """The log without the rows first..last of each span."""
    rows = np.arange(len(log.t_s))
    return rows_of(log, ~np.any([(rows >= first) & (rows <= last) for first, last in spans], axis=0))


def cut(log: RunLog) -> list[tuple[str, int]]:
    found = unbroken([log], [np.ones(len(log.t_s), bool)], [gaps(log.t_s)], ["a"])
    return [(name, len(part.t_s)) for name, part in zip(found.names, found.logs, strict=True)]


@pytest.mark.parametrize(("rows", "count"), [(3, 1), (4, 2), (100, 2), (1000, 2)])
def test_more_than_three_missing_rows_end_a_log(rows: int, count: int) -> None:
    log = lost(log_of(), (600, 599 + rows))
    assert len(cut(log)) == count
    assert len(list(break_findings(log, "a"))) == count - 1


def test_stretches_keep_their_times_and_say_where_they_begin() -> None:
    log = lost(log_of(), (600, 699), (1500, 1500), (1800, 1804))
    assert cut(log) == [("a", 600), ("a (from 7 s)", 1099), ("a (from 18.05 s)", 195)]
    (found,) = break_findings(log, "a")
    assert found.finding.sentence.startswith("no rows from 5.99 s to 7 s, 17.99 s to 18.05 s: what follows")


def test_stretches_too_short_for_a_log_are_left_out_and_none_but_such_are_refused() -> None:
    log = lost(log_of(), (600, 699), (720, 800))
    whole = unbroken([log], [np.ones(len(log.t_s), bool)], [gaps(log.t_s)], ["a"])
    assert whole.of == ("a", "a")
    assert [note.kind for note in whole.notes] == ["short_stretches"]
    torn = lost(log_of(300), *((first, first + 9) for first in range(40, 300, 50)))
    with pytest.raises(BadInput, match="none of which is a log by itself"):
        cut(torn)


def test_rows_at_random_times_are_no_breaks() -> None:
    steps = np.random.default_rng(4).exponential(0.01, 2000)
    assert gaps(np.cumsum(steps)).sum() <= 2
    half = np.random.default_rng(5).random(4000) < 0.5
    assert not gaps(0.01 * np.flatnonzero(half)).any()
    slower = np.concatenate([0.01 * np.arange(500), 5.0 + 0.08 * np.arange(500)])
    assert gaps(slower).sum() <= 1


@pytest.mark.parametrize("share", [0.001, 0.01, 0.05])
def test_readings_of_zero_now_and_then_are_left_out_and_those_of_an_axis_that_passes_zero_are_not(share: float) -> None:
    log = log_of()
    honest = log.y[:, 0] == 0.0
    failed = np.random.default_rng(6).random(len(log.t_s)) < share
    far = np.abs(log.y[:, 0]) > 40 * STEP_RAD
    y = log.y.copy()
    y[failed, 0] = 0.0
    (found,) = zero_findings(replace(log, y=y), "a", "psi_rad", STEP_RAD)
    assert found.excluded is not None
    assert found.excluded[failed & far].all()
    assert not found.excluded[~failed & ~honest].any()
    assert list(zero_findings(log, "a", "psi_rad", STEP_RAD)) == []


@pytest.mark.parametrize("ends", [(0,), (-1,), (0, 1, -2, -1)])
def test_readings_of_zero_at_the_ends_of_a_log_are_left_out_where_others_are(ends: tuple[int, ...]) -> None:
    # Truth: a sensor far from zero reads it in single rows amid the log, and in its first or last rows.
    log = log_of()
    far = replace(log, y=np.add(log.y, (1.0, 0.0)))
    y = far.y.copy()
    y[ends, 0] = 0.0
    assert (
        list(zero_findings(replace(far, y=y), "a", "psi_rad", STEP_RAD)) == []
    )  # alone they may be where the axis was
    y[[700, 1200], 0] = 0.0
    (found,) = zero_findings(replace(far, y=y), "a", "psi_rad", STEP_RAD)
    assert found.excluded is not None
    assert np.array_equal(found.excluded, y[:, 0] == 0.0)


def test_an_axis_that_often_rests_beside_zero_keeps_its_zeros_where_a_few_readings_are_lost() -> None:
    # Truth: an axis hunts by one count about zero, 0 in every second row, and two of its readings on a step of 0.5 rad were lost.
    log = log_of()
    y = log.y.copy()
    y[:, 0] = STEP_RAD * (np.arange(len(log.t_s)) % 2)
    y[1000:1200, 0] += rounded(0.5 * np.sin(np.pi * np.arange(200) / 200.0))
    y[[1080, 1120], 0] = 0.0
    (found,) = zero_findings(replace(log, y=y), "a", "psi_rad", STEP_RAD)
    assert found.excluded is not None
    assert np.flatnonzero(found.excluded).tolist() == [1080, 1120]


def read_back(log: RunLog, folder: Path) -> RunLog:
    save_log(folder / "a.csv", log)
    return load_log(folder / "a.csv", log.columns)


@pytest.mark.parametrize(("back_s", "begins"), [(0.03, False), (0.045, True), (0.4, True)])
def test_a_clock_that_was_set_back_loses_rows_and_what_follows_is_another_log(
    back_s: float, begins: bool, tmp_path: Path
) -> None:
    """Truth: rows that lie further apart in time than their stamps say, once those are left out whose times had been."""
    log = log_of()
    t_s = np.where(np.arange(2000) < 1000, log.t_s, log.t_s - back_s)
    read = read_back(replace(log, t_s=t_s), tmp_path)
    (entry,) = examine([read], PLANT, names=["a"]).logs
    assert bool(entry.begins.any()) is begins
    assert not begins or np.flatnonzero(entry.begins).tolist() == [1000]


def test_a_clock_that_was_set_back_bears_no_stamps_coarser_than_the_rows(tmp_path: Path) -> None:
    log = log_of()
    read = read_back(replace(log, t_s=np.where(np.arange(2000) < 1000, log.t_s, np.round(log.t_s - 0.3, 2))), tmp_path)
    assert read.mended.spread is None
    assert read.mended.disordered is not None
    assert read.mended.disordered.rows == 30


def test_a_last_row_that_was_written_in_part_is_told(tmp_path: Path) -> None:
    """Truth: the supply failed within the last row, which had three of its five cells."""
    log = log_of()
    save_log(tmp_path / "a.csv", log)
    text = (tmp_path / "a.csv").read_text()
    (tmp_path / "a.csv").write_text(text.rstrip("\n").rsplit(",", 2)[0])
    read = load_log(tmp_path / "a.csv", log.columns)
    assert len(read.t_s) == len(log.t_s) - 1
    (finding,) = [entry for entry in examine([read], PLANT, names=["a"]).findings if entry.kind == "half_row"]
    assert "line 2001, the last" in finding.sentence


def test_rows_in_which_nothing_was_written_are_said_and_what_four_of_them_part_is_another_log(tmp_path: Path) -> None:
    """Truth: a logger lost five records in a row and left zeros beside their times, where the axis is far from 0."""
    log = log_of()
    first = int(np.flatnonzero(np.abs(log.y[:, 0]) > 60 * STEP_RAD)[10])
    lost = np.isin(np.arange(len(log.t_s)), np.arange(first, first + 5))
    zeroed = replace(log, u=np.where(lost[:, None], 0.0, log.u), y=np.where(lost[:, None], 0.0, log.y))
    looked = examine([read_back(zeroed, tmp_path)], PLANT, names=["a"])
    (said,) = [entry for entry in looked.findings if entry.kind == "unwritten_rows"]
    assert said.sentence == f"nothing was written in 5 rows, first at {log.t_s[first]:.6g} s; left out"
    assert np.flatnonzero(looked.logs[0].begins).tolist() == [first]
    assert not any(entry.kind == "zero_reading" for entry in looked.findings)
