"""What a log's time stamps and sequence numbers say: true sample period, jitter, missing and repeated rows."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import EXCLUDE, NOTE, REFUSE, Array, Finding, Found, Rows, in_words
from records.log import RunLog
from records.logs.restarts import restart_rows
from records.reasons import THINNED, Note


@dataclass(frozen=True)
class Timing:
    """Statistics of the time stamps; `period_s` is the slope of time over sample number, `period_error_ppm` against the sidecar.

    Jitter is the deviation of a step from whole periods. `missing_by_time` and `missing_by_seq` count samples without a row, None without
    sequence numbers.
    """

    rows: int
    duration_s: float
    period_s: float
    period_error_ppm: float
    jitter_rms_s: float
    jitter_max_s: float
    missing_by_time: int
    missing_by_seq: int | None


def timing(log: RunLog) -> Timing:
    """The timing of a log; for fewer than three rows the stated period stands."""
    t_s, stated_s = _without_pauses(log), log.sample_period_s
    n = len(t_s)
    duration_s = float(t_s[-1] - t_s[0]) if n else 0.0
    if n < 3 or not np.isfinite(duration_s):
        return Timing(n, duration_s, stated_s, 0.0, 0.0, 0.0, 0, None)
    steps = np.diff(t_s)
    usual_s = float(np.median(steps))
    by_time = np.maximum(np.round(steps / usual_s), 0.0) if usual_s > 0.0 else np.ones(n - 1)
    by_seq = by_time if log.seq is None else np.maximum(np.diff(log.seq), 0)
    # Where the two disagree in all, times were not taken where the samples were: then only times tell of time.
    counted = by_seq if by_seq.sum() == by_time.sum() else by_time
    samples = np.concatenate([[0.0], np.cumsum(counted)])
    period_s = _slope(samples, t_s)
    jitter_s = (steps - counted * period_s)[counted == by_time]
    jitter_s = jitter_s if jitter_s.size else np.zeros(1)
    jitter_rms_s = float(np.sqrt(np.mean(jitter_s**2)))
    return Timing(
        rows=n,
        duration_s=duration_s,
        period_s=period_s,
        period_error_ppm=(period_s / stated_s - 1.0) * 1e6,
        jitter_rms_s=jitter_rms_s,
        jitter_max_s=float(np.abs(jitter_s).max()),
        missing_by_time=int(np.sum(by_time[_are_gaps(steps, period_s, jitter_rms_s)] - 1.0)),
        missing_by_seq=None if log.seq is None else int(np.sum(np.maximum(by_seq - 1, 0))),
    )


def _are_gaps(steps: Array, period_s: float, jitter_rms_s: float) -> Rows:
    """Steps (n,) from row to row that are longer than late and early stamps make them: samples are missing there."""
    return np.asarray(steps > thresholds.GAP_PERIODS * period_s + thresholds.GAP_JITTER * jitter_rms_s)


def _without_pauses(log: RunLog) -> Array:
    """The times with one usual step in front of each other recording of the file."""
    steps = np.diff(log.t_s)
    rows = np.searchsorted(log.t_s, [entry.at_s for entry in log.mended.restarts]) - 1
    steps[rows] = np.median(steps) if rows.size else 0.0
    return np.concatenate([log.t_s[:1], log.t_s[:1] + np.cumsum(steps)]) if rows.size else log.t_s


def _slope(samples: Array, t_s: Array) -> float:
    """Least squares of time over sample number."""
    x = samples - samples.mean()
    spread = float(x @ x)
    return float(x @ (t_s - t_s.mean())) / spread if spread > 0.0 else 0.0


def timing_findings(log: RunLog, name: str, found: Timing) -> Iterator[Found]:
    """What is odd about the times of a log."""
    start_s, end_s = (float(log.t_s[0]), float(log.t_s[-1])) if found.rows else (0.0, 0.0)

    def say(kind: str, sentence: str, severity: str = NOTE, expected: str = "", remedy: str = "") -> Found:
        return Found(Finding(kind, name, "t_s", start_s, end_s, sentence, severity, 0, expected, remedy))

    if found.rows < thresholds.LEAST_ROWS:
        got = f"{in_words(found.rows, 'row')} over {found.duration_s:g} s"
        yield say("too_short", got, REFUSE, f"at least {thresholds.LEAST_ROWS} rows", "record a longer run")
        return
    yield from _order(log, name)
    is_off = abs(found.period_error_ppm) > max(thresholds.PERIOD_ERROR_PPM, _by_jitter_ppm(found))
    apart = f"the rows are {found.period_s:.8g} s apart, not {log.sample_period_s:g} s"
    by_number = _step_of_numbers(log)
    written = by_number if by_number > 1 else _so_many(found, log)
    if written > 1 and _moves(log.u) > thresholds.THINNED_MOVES:
        told = f"sequence numbers rise by {by_number} from row to row" if by_number > 1 else apart
        yield say(
            THINNED,
            f"{told}: 1 in {written} was written, and what was commanded in the others is not known: {_DOUBTFUL}",
        )
    elif is_off:
        how_far = f": 1 in {written} was written" if written > 1 else f" ({found.period_error_ppm:+.0f} ppm)"
        yield say("sample_period", f"{apart}{how_far}; their own times are used")
    if found.jitter_rms_s > thresholds.JITTER_PERIODS * found.period_s:
        yield say(
            "jitter",
            f"time stamps jitter by {found.jitter_rms_s:.3g} s rms, {found.jitter_max_s:.3g} s at most; true times are used",
        )
    yield from _missing(log, name, found)


_DOUBTFUL = "whatever is found may be farther off than its interval says"


def _so_many(found: Timing, log: RunLog) -> int:
    """Of how many samples by the stated period one row was written: 1 where all were, or where it is another one."""
    times = found.period_s / log.sample_period_s
    is_whole = round(times) >= 2 and abs(times / round(times) - 1.0) < thresholds.OF_SO_MANY
    return round(times) if is_whole else 1


def _step_of_numbers(log: RunLog) -> int:
    """By how much sequence numbers usually rise from row to row; 1 without any."""
    return 1 if log.seq is None else int(np.median(np.diff(log.seq)))


def _moves(u: Array) -> float:
    """Share of the rows in which an input is not what it was in the row before."""
    return float((np.diff(u, axis=0) != 0.0).any(axis=1).mean())


def _by_jitter_ppm(found: Timing) -> float:
    """How far jitter that adds up from row to row moves the period, four standard deviations."""
    return float(4e6 * found.jitter_rms_s / np.sqrt(found.rows) / found.period_s)


def _order(log: RunLog, name: str) -> Iterator[Found]:
    """Rows whose time or sequence number does not rise: the later one is left out."""
    yield from _not_rising(log, name, "t_s", log.t_s)
    if log.seq is None:
        return
    begins = restart_rows(log.seq.astype(float))
    if begins.size:
        yield _numbered_anew(log, name, begins)
    else:
        yield from _not_rising(log, name, "seq", log.seq.astype(float))


def _numbered_anew(log: RunLog, name: str, rows: NDArray[np.int64]) -> Found:
    """Sequence numbers that begin again while the clock goes on: the board was started anew."""
    begins: Rows = np.zeros(len(log.t_s), bool)
    begins[rows] = True
    at = log.t_s[rows]
    sentence = f"sequence numbers begin again at {', '.join(f'{t:.6g} s' for t in at[:3])}: what follows is used as another log"
    return Found(Finding("restart", name, "seq", float(at[0]), float(at[-1]), sentence), begins=begins)


def _not_rising(log: RunLog, name: str, column: str, values: Array) -> Iterator[Found]:
    highest = np.maximum.accumulate(values)
    bad: Rows = np.concatenate([[False], values[1:] <= highest[:-1]])
    repeated = np.concatenate([[False], values[1:] == values[:-1]])
    for kind, rows, what in (
        ("repeated_rows", bad & repeated, "repeat the number before"),
        ("disordered_rows", bad & ~repeated, "go back"),
    ):
        if rows.any():
            at = log.t_s[rows]
            count = int(rows.sum())
            sentence = f"{column}: {in_words(count, 'row')} {what}, first at {at[0]:g} s; left out"
            yield Found(Finding(kind, name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, count), rows)


def _missing(log: RunLog, name: str, found: Timing) -> Iterator[Found]:
    steps = np.diff(_without_pauses(log))
    gaps = np.flatnonzero(_are_gaps(steps, found.period_s, found.jitter_rms_s))
    if gaps.size and found.missing_by_time:
        first, longest = gaps[0], gaps[np.argmax(steps[gaps])]
        sentence = (
            f"{in_words(found.missing_by_time, 'sample')} missing in {in_words(gaps.size, 'gap')}, first behind "
            f"{log.t_s[first]:g} s, the longest {steps[longest]:.3g} s behind {log.t_s[longest]:g} s"
        )
        span = (float(log.t_s[first]), float(log.t_s[gaps[-1] + 1]))
        yield Found(Finding("missing_rows", name, "t_s", *span, sentence))
    if log.seq is None:
        return
    lost = np.flatnonzero(np.diff(log.seq) > 1)
    if lost.size:
        sentence = f"sequence numbers: {in_words(found.missing_by_seq or 0, 'sample')} missing, first behind {log.t_s[lost[0]]:g} s"
        span = (float(log.t_s[lost[0]]), float(log.t_s[lost[-1] + 1]))
        yield Found(Finding("sequence_gap", name, "seq", *span, sentence))
    if found.missing_by_seq != found.missing_by_time:
        sentence = (
            f"sequence numbers lack {found.missing_by_seq}, time stamps {found.missing_by_time} samples: "
            "the times were not taken where the samples were"
        )
        yield Found(Finding("sequence_against_time", name, "seq", float(log.t_s[0]), float(log.t_s[-1]), sentence))


def from_their_start(logs: Sequence[RunLog], names: Sequence[str]) -> tuple[list[RunLog], tuple[Note, ...]]:
    """The logs, those that start beyond CALENDAR_S with times from their own start, and a note for each of these.

    Seconds since 1970 leave no digits for a step of time, and no instant near 0.
    """
    found, notes = [], []
    for log, name in zip(logs, names, strict=True):
        start_s = float(log.t_s[0])
        if abs(start_s) > thresholds.CALENDAR_S:
            said = f"{name}: its times start at {start_s:.0f} s; all times given here count from there"
            notes.append(Note("calendar_clock", name, {"start_s": start_s}, said))
            log = replace(log, t_s=log.t_s - start_s)
        found.append(log)
    return found, tuple(notes)
