"""What the numbers of a log's columns say by themselves: missing, constant, saturated, copied, out of line; and how much moves."""

from collections.abc import Collection, Iterator, Mapping
from types import MappingProxyType

import numpy as np

from logcheck import thresholds
from logcheck.finding import EXCLUDE, NOTE, REFUSE, Array, Finding, Found, Rows, beginning, in_words, without
from logcheck.grid import grids_read
from logcheck.held import held_findings, stale_findings
from logcheck.leaps.motion import wrap_findings
from logcheck.leaps.seams import seam_findings
from logcheck.spikes import spike_findings
from logcheck.stands.clipped import clipped_findings
from logcheck.stands.dead import dead_findings, read_again
from logcheck.stands.standing import end_findings
from logcheck.zeros import zero_findings
from records.log import RunLog
from sim.columns import reference_name


def value_findings(
    log: RunLog,
    name: str,
    steps: Mapping[str, float],
    positions: Collection[str] = (),
    stops: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    moved_by: Mapping[str, Collection[str]] = MappingProxyType({}),
) -> Iterator[Found]:
    """What is odd about the numbers, whatever the plant; `positions` are outputs that a mass moves, `stops` where it is stopped, and
    `moved_by` by which inputs an output moves, where not by any."""
    yield from _missing_numbers(log, name)
    wrapped = list(wrap_findings(log, name, steps, positions))
    yield from wrapped
    if wrapped:  # its leaps are neither glitches nor other recordings
        return
    steps = grids_read(log, steps)
    yield from _constant(log, name)
    yield from _copies(log, name)
    zeros = [
        found for column in log.columns.outputs for found in zero_findings(log, name, column, steps.get(column, 0.0))
    ]
    yield from zeros
    log = without(log, zeros)
    again = read_again(log)
    seams = list(seam_findings(log, name, steps, again, positions))
    begins = beginning(seams, len(log.t_s))
    clipped = list(clipped_findings(log, name, steps, begins, positions, stops))
    read = without(log, clipped)
    held = list(held_findings(read, name))
    dead = held or list(dead_findings(read, name, steps, begins, positions, again))
    if _ends_in(dead, begins):  # a leap out of readings that are none is no seam
        seams = list(seam_findings(without(log, dead), name, steps, again, positions))
        begins = beginning(seams, len(log.t_s))
    yield from seams
    yield from clipped
    log = read
    yield from dead
    if not held:
        yield from stale_findings(log, name, steps, positions)
    yield from end_findings(without(log, dead), name, steps, begins, positions, moved_by)
    glitches = [
        found for column in log.columns.outputs for found in _glitches(log, name, column, steps.get(column, 0.0))
    ]
    yield from glitches
    if not held:
        read = without(log, [*dead, *glitches])
        for column in (column for column in log.columns.outputs if column in positions):
            yield from spike_findings(read, name, column, steps.get(column, 0.0))


def _ends_in(dead: Collection[Found], begins: Rows) -> bool:
    """Whether another log is said to begin in the row in which an output is read again."""
    return any(bool((entry.excluded[:-1] & begins[1:]).any()) for entry in dead if entry.excluded is not None)


def _missing_numbers(log: RunLog, name: str) -> Iterator[Found]:
    for column in (*log.columns.outputs, *log.extra):
        rows = np.flatnonzero(np.isnan(log.column(column)))
        if not rows.size:
            continue
        span = (float(log.t_s[rows[0]]), float(log.t_s[rows[-1]]))
        if rows.size == len(log.t_s):
            yield Found(Finding("not_recorded", name, column, *span, f"{column} was not recorded: NaN in every row"))
            continue
        runs = 1 + int(np.sum(np.diff(rows) > 1))
        spans = in_words(runs, "span")
        sentence = f"{column} is NaN in {in_words(rows.size, 'row')} in {spans}, first at {span[0]:g} s; not measured"
        yield Found(Finding("not_a_number", name, column, *span, sentence))


def _constant(log: RunLog, name: str) -> Iterator[Found]:
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    still = [column for column in (*log.columns.inputs, *log.columns.outputs) if _is_constant(log.column(column))]
    references = {reference_name(output) for output in log.columns.outputs}
    if any(name not in references and not _is_constant(values) for name, values in log.extra.items()):
        pass  # a rate or a rotor speed was measured: the rest may stand still
    elif len(still) == len(log.columns.inputs) + len(log.columns.outputs):
        sentence = "every input and every output is one constant"
        yield Found(Finding("constant", name, None, *span, sentence, REFUSE, 0, "a run that moves", "record one"))
        return
    elif np.isnan(log.y).all():
        sentence = "no output was ever measured: NaN in every row"
        yield Found(
            Finding(
                "not_recorded", name, None, *span, sentence, REFUSE, 0, "outputs that were read", "record another run"
            )
        )
        return
    elif set(log.columns.outputs) <= set(still) and not log.locked:
        sentence = (
            "inputs change and no output ever does: sensors that were not read, or a plant that never left its rest"
        )
        yield Found(
            Finding("stuck_sensors", name, None, *span, sentence, REFUSE, 0, "outputs that answer", "check the sensors")
        )
        return
    for column in still:
        if np.isnan(log.column(column)).all():
            continue
        yield Found(Finding("constant", name, column, *span, f"{column} is {log.column(column)[0]:g} in every row"))


def _is_constant(values: Array) -> bool:
    present = values[np.isfinite(values)]
    return bool(present.size == 0 or present.min() == present.max())


def _copies(log: RunLog, name: str) -> Iterator[Found]:
    """A measured output that is a reference, or another column, number for number."""
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    names = [*log.columns.outputs, *log.columns.inputs, *log.extra]
    for index, column in enumerate(names):
        for other in names[index + 1 :]:
            if not _is_copy(log.column(column), log.column(other)):
                continue
            is_reference = column in log.columns.outputs and other == reference_name(column)
            sentence = f"{column} is {other}, number for number" + (": no measurement" if is_reference else "")
            severity = REFUSE if column in log.columns.outputs else NOTE
            remedy = f"log what the sensor of {column} measured"
            yield Found(Finding("copied_column", name, column, *span, sentence, severity, 0, "two columns", remedy))


def _is_copy(one: Array, other: Array) -> bool:
    sparse = slice(None, None, max(1, len(one) // 5000))
    if np.mean(one[sparse] == other[sparse]) < thresholds.COPY_SHARE or _is_constant(one):
        return False
    return bool(np.mean(one == other) >= thresholds.COPY_SHARE)


def _usual_move(off: Array) -> float:
    """How far readings usually are from the nearer of their neighbours, whatever a glitch in twenty may add to that."""
    some = off[np.isfinite(off)][:: max(1, len(off) // 20000)]
    often, most = np.percentile(some, (90.0, 99.0)) if some.size else (0.0, 0.0)
    return float(often if often > 0.0 else most)


def _ends_off(values: Array, bound: float) -> list[bool]:
    """Whether the first of three readings is far off the way of the others, which are near one another, as one made before the sensor
    was ready is."""
    off = abs(float(values[0] - (2.0 * values[1] - values[2])))
    return [bool(0.0 < bound < off and abs(float(values[1] - values[2])) < 0.1 * off)]


def _glitches(log: RunLog, name: str, column: str, step: float) -> Iterator[Found]:
    """Single rows far off both neighbours, which agree with each other: no motion does that."""
    values = log.column(column)
    if len(values) < 3:
        return
    before, after = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    off = np.minimum(np.abs(before), np.abs(after))
    across = np.abs(values[2:] - values[:-2])
    usual = _usual_move(off)
    bound = max(thresholds.GLITCH_FACTOR * usual, thresholds.GLITCH_STEPS * step)
    with np.errstate(invalid="ignore"):
        inner = (
            (off > bound) & (across < 0.25 * off) & (before * after > 0.0) if bound > 0.0 else np.zeros(len(off), bool)
        )
    rows: Rows = np.concatenate([_ends_off(values[:3], bound), inner, _ends_off(values[:-4:-1], bound)])
    if rows.any():
        count, at = int(rows.sum()), log.t_s[rows]
        sentence = f"{column} leaps away and back in {in_words(count, 'row')}, first at {at[0]:g} s; left out"
        yield Found(Finding("glitch", name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, count), rows)
