"""Rows that are missing, come twice or out of order, and clocks that are off or jitter."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.stamps import timing
from records.reasons import DOUBTS
from tests.logcheck.flight import clean, examined, kinds
from tests.replay.firmware_flights import rows_of


def test_missing_rows_are_counted_by_time_and_by_number() -> None:
    log, kept = clean(), np.ones(2001, bool)
    assert (timing(log).missing_by_time, timing(log).missing_by_seq) == (0, None)
    kept[[300, 301, 900]] = False
    gappy = rows_of(replace(log, seq=np.arange(2001)), kept)
    assert kinds(examined(gappy)) == {"missing_rows", "sequence_gap"}
    assert (timing(gappy).missing_by_time, timing(gappy).missing_by_seq) == (3, 3)
    closed_up = replace(rows_of(replace(log, seq=np.arange(2001)), kept), t_s=log.t_s[:-3])
    assert kinds(examined(closed_up)) == {"sequence_gap", "sequence_against_time"}


def test_repeated_and_disordered_rows_are_left_out() -> None:
    log = clean()
    seq = np.arange(2001)
    seq[500] = 499
    seq[800] = 700
    found = examined(replace(log, seq=seq))
    assert kinds(found, "exclude") == {"repeated_rows", "disordered_rows"}
    assert np.flatnonzero(found.logs[0].excluded).tolist() == [500, 800]


def test_a_clock_that_is_off_and_one_that_jitters_are_told_apart() -> None:
    log = clean()
    off = replace(log, t_s=log.t_s * 1.002)
    assert kinds(examined(off)) == {"sample_period"}
    assert timing(off).period_error_ppm == pytest.approx(2000.0, rel=1e-6)
    thinned = replace(log, t_s=log.t_s * 2.0)
    (found,) = examined(thinned).findings
    assert (found.kind, found.kind in DOUBTS) == ("thinned_rows", True)
    assert (
        "0.02 s apart, not 0.01 s: 1 in 2 was written, and what was commanded in the others is not known"
        in found.sentence
    )
    # Truth: the same rows of a log whose sidecar states their 20 ms, and whose board counted every sample.
    (numbered,) = [
        entry
        for entry in examined(replace(thinned, sample_period_s=0.02, seq=2 * np.arange(2001))).findings
        if entry.kind in DOUBTS
    ]
    assert "sequence numbers rise by 2 from row to row: 1 in 2 was written" in numbered.sentence
    slow = replace(
        thinned, u=np.repeat(log.u[::50], 50, axis=0)[: len(log.u)]
    )  # an input that stands was known between them
    assert "thinned_rows" not in kinds(examined(slow))
    late_s = np.random.default_rng(4).uniform(0.0, 1e-3, 2001)
    jittered = replace(log, t_s=log.t_s + late_s)
    assert kinds(examined(jittered)) == {"jitter"}
    # Truth: rows up to 4 ms early or late, all of them there; and rows up to 1 ms late, of which one is not.
    rough = replace(log, t_s=log.t_s + np.random.default_rng(6).uniform(-4e-3, 4e-3, 2001))
    assert kinds(examined(rough)) == {"jitter"}
    one_less = rows_of(jittered, np.arange(2001) != 700)
    assert (kinds(examined(one_less)), timing(one_less).missing_by_time) == ({"jitter", "missing_rows"}, 1)
    assert timing(jittered).jitter_rms_s == pytest.approx(1e-3 * np.sqrt(1.0 / 6.0), rel=0.05)
    # Truth: rows 10 ms apart on average, each late by its own 2 ms rms: 2000 of these move the mean by 4500 ppm rms, and not the clock.
    steps_s = 0.01 + np.random.default_rng(5).uniform(-1.0, 1.0, 2000) * 2e-3 * np.sqrt(3.0)
    waiting = replace(log, t_s=np.concatenate([[0.0], np.cumsum(steps_s)]))
    assert abs(timing(waiting).period_error_ppm) > 500.0
    assert "sample_period" not in kinds(examined(waiting))
