"""A log is a list of stretches without a break: where rows are missing, or another recording begins, what follows is another log.

Who uses a log takes its stretches as logs of their own; how far the plant went in between, and by what inputs, nobody knows.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import Array, Finding, Found, Rows, in_words
from logcheck.leaps.seams import behind_lost_times
from logcheck.stretches import Stretches, part, stretch_name
from records.errors import BadInput
from records.log import RunLog
from records.reasons import Note


def gaps(t_s: Array) -> Rows:
    """Rows (n,) in front of which more samples are missing than a filter can bridge; none where rows come at random times."""
    begins: Rows = np.zeros(len(t_s), bool)
    steps = np.diff(t_s)
    if not steps.size:
        return begins
    for row in np.flatnonzero(steps > (thresholds.BRIDGED_ROWS + 1.5) * float(np.median(steps))).tolist():
        around = steps[max(0, row - thresholds.AROUND_GAP_ROWS) : row + thresholds.AROUND_GAP_ROWS + 1]
        usual_s = (thresholds.BRIDGED_ROWS + 1.5) * float(np.median(around))
        often_s = thresholds.LONGER_THAN_OFTEN * float(np.percentile(around, thresholds.OFTEN_PERCENT))
        begins[row + 1] = steps[row] > max(usual_s, often_s)
    return begins


def break_findings(log: RunLog, name: str) -> Iterator[Found]:
    """Notes on rows in which nothing was written, or of the last one a part, on inputs that begin late, on stamps too coarse to tell rows
    apart, on rows out of order, on other recordings in the file, and on stretches without rows, behind which the log goes on as another
    one."""
    if log.mended.half_row:
        end_s = float(log.t_s[-1])
        yield Found(Finding("half_row", name, None, end_s, end_s, log.mended.half_row.told, rows=1))
    for late in log.mended.late_inputs:
        sentence = (
            f"{late.column} begins at {late.begins_s:.6g} s: {in_words(late.rows, 'row')} in front of it left out"
        )
        yield Found(Finding("late_input", name, late.column, late.begins_s, late.begins_s, sentence, rows=late.rows))
    if log.mended.spread:
        span = (float(log.t_s[0]), float(log.t_s[-1]))
        yield Found(
            Finding("coarse_stamps", name, "t_s", *span, f"t_s: {log.mended.spread.told}", rows=log.mended.spread.rows)
        )
    if log.mended.unwritten:
        count, first_s = log.mended.unwritten.rows, log.mended.unwritten.first_s
        sentence = f"nothing was written in {in_words(count, 'row')}, first at {first_s:.6g} s; left out"
        yield Found(Finding("unwritten_rows", name, None, first_s, first_s, sentence, rows=count))
    if log.mended.disordered:
        count, first_s = log.mended.disordered.rows, log.mended.disordered.first_s
        sentence = f"t_s: {in_words(count, 'row')} whose time does not rise, first at {first_s:.6g} s; left out"
        begins = behind_lost_times(log)
        if begins.any():
            anew = " and ".join(f"{at_s:.6g} s" for at_s in log.t_s[begins][: thresholds.TIMES_SHOWN])
            sentence += f"; from {anew} on the log is used as another one"
        yield Found(Finding("disordered_rows", name, "t_s", first_s, first_s, sentence, rows=count), begins=begins)
    restarts = np.searchsorted(log.t_s, [entry.at_s for entry in log.mended.restarts])
    if restarts.size:
        yield _restarted(log, name, restarts)
    missing = gaps(log.t_s)
    missing[restarts] = False
    rows = np.flatnonzero(missing)
    if not rows.size:
        return
    spans = [f"{log.t_s[row - 1]:.6g} s to {log.t_s[row]:.6g} s" for row in rows[: thresholds.TIMES_SHOWN]]
    more = f" and in {len(rows) - thresholds.TIMES_SHOWN} more" if len(rows) > thresholds.TIMES_SHOWN else ""
    sentence = f"no rows from {', '.join(spans)}{more}: what follows is used as another log"
    span = (float(log.t_s[rows[0] - 1]), float(log.t_s[rows[-1]]))
    yield Found(Finding("break", name, "t_s", *span, sentence), begins=missing)


def _restarted(log: RunLog, name: str, rows: NDArray[np.int64]) -> Found:
    begins: Rows = np.zeros(len(log.t_s), bool)
    begins[rows] = True
    told = [
        f"at {entry.own_s:g} s behind {log.t_s[row - 1]:.6g} s, which counts as {entry.at_s:g} s here"
        for entry, row in zip(log.mended.restarts[: thresholds.TIMES_SHOWN], rows.tolist(), strict=False)
    ]
    more = f" and {len(rows) - thresholds.TIMES_SHOWN} times more" if len(rows) > thresholds.TIMES_SHOWN else ""
    sentence = f"times begin again {', '.join(told)}{more}: several recordings in one file; each is used as another log"
    span = (float(log.t_s[rows[0]]), float(log.t_s[rows[-1]]))
    return Found(Finding("restart", name, "t_s", *span, sentence), begins=begins)


def unbroken(logs: Sequence[RunLog], used: Sequence[Rows], begins: Sequence[Rows], names: Sequence[str]) -> Stretches:
    """The stretches of all logs; `begins` (n,) are the rows of each that begin another one, `used` (n,) those that may be used.

    A log without a break stays as it is. Stretches that are too short for a log are left out, with a note; raises BadInput for a log
    that has no others.
    """
    parts: list[tuple[RunLog, str, Rows, str]] = []
    notes: list[Note] = []
    for log, mask, marked, name in zip(logs, used, begins, names, strict=True):
        whole = [slice(*ends) for ends in pairwise([0, *np.flatnonzero(marked).tolist(), len(log.t_s)])]
        kept = [rows for rows in whole if len(whole) == 1 or _is_a_log(log, rows)]
        if not kept:
            got = f"{in_words(len(whole), 'stretch')} between breaks, none of which is a log by itself"
            least = f"one of {thresholds.LEAST_ROWS} rows at least"
            raise BadInput("log", name, got, least, "record the run again, without losing rows")
        if len(kept) < len(whole):
            lost = len(log.t_s) - sum(rows.stop - rows.start for rows in kept)
            said = f"{name}: {in_words(lost, 'row')} between breaks, too few for a log of their own; left out"
            notes.append(Note("short_stretches", name, {"rows": lost}, said))
        parts += [
            (log if len(whole) == 1 else part(log, rows), _called(log, name, rows), mask[rows], name) for rows in kept
        ]
    cut, called, masks, of = zip(*parts, strict=True) if parts else ((), (), (), ())
    return Stretches(cut, called, masks, tuple(notes), of)


def _called(log: RunLog, name: str, rows: slice) -> str:
    return name if rows.start == 0 else stretch_name(log, name, rows)


def _is_a_log(log: RunLog, rows: slice) -> bool:
    return rows.stop - rows.start >= thresholds.LEAST_ROWS and bool(np.isfinite(log.y[rows]).any())
