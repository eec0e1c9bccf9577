"""An output that stands where the plant foretells that it moves on: at an end of its sensor's range, or to the log's end, read no more.

How far to trust the plant is asked of the log itself: wherever else the output rests, the plant says where it is a little later, and is
off by so much at most. So friction that the plant lacks, a wrong weight and an unknown wind count for nothing.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.ahead import read_ahead, states_along, with_axes_as_read
from logcheck.facts import PlantFacts
from logcheck.finding import EXCLUDE, Array, Finding, Found, Rows, without
from logcheck.stands.column import runs
from logcheck.stands.standing import dead_end, last_stand
from records.log import RunLog
from records.text.units import unit_of
from sim.bind import BoundPlant

Places = NDArray[np.int64]


@dataclass(frozen=True)
class _Off:
    """How far the plant is off at most a little behind a rest, in the stands that are asked of and elsewhere; after `ahead_s`."""

    here: float
    elsewhere: float
    ahead_s: float

    @property
    def tells(self) -> bool:
        return self.here > thresholds.FORETOLD_TIMES * self.elsewhere

    def told(self, unit: str) -> str:
        return (
            f"where the plant foretells that it moves by {self.here:.2g} {unit} within {self.ahead_s:.2g} s; where it rests elsewhere "
            f"the plant is off by {self.elsewhere:.2g} {unit} at most"
        )


def foretold_findings(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts, begins: Rows) -> Iterator[Found]:
    """The stands of each axis' output at an end of its range, and its last one, from which the plant foretells that it moves; `begins` (n,)
    as for dead stretches."""
    first = int(np.max(np.flatnonzero(begins), initial=0))
    for column in sorted(facts.positions):
        ends = list(_range_ends(log, name, bound, facts, column))
        yield from ends
        yield from _last_stand(without(log, ends), name, bound, facts, column, first)


def _range_ends(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts, column: str) -> Iterator[Found]:
    values = log.column(column)
    known, (low, high) = values[np.isfinite(values)], facts.stops.get(column, (-np.inf, np.inf))
    found = last_stand(log, column, 0, facts.steps.get(column, 0.0))
    if found is None:
        return
    _, _, least = found
    for level, how in ((known.max(), "exceeds"), (known.min(), "falls below")):
        if not low + thresholds.BEYOND_STOP_rad < level < high - thresholds.BEYOND_STOP_rad:
            continue
        stands = [(begin, end) for begin, end in runs(values) if values[begin] == level and end + 1 < len(values)]
        inside: Rows = np.zeros(len(values), bool)
        for begin, end in stands:
            inside[begin : end + 1] = True
        off = _off(log, bound, column, inside, 0, least)
        if off.tells:
            unread, unit = values == level, unit_of(column) or ""
            at = log.t_s[inside]
            sentence = (
                f"{column} never {how} {level:.5g} {unit}, at which it is in {unread.sum() / known.size:.1%} of its readings, first from "
                f"{at[0]:.6g} s on, {off.told(unit)}: the sensor's range ends there; left out"
            )
            finding = Finding(
                "clipped_sensor", name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, int(unread.sum())
            )
            yield Found(finding, unread)


def _last_stand(
    log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts, column: str, first: int
) -> Iterator[Found]:
    found = last_stand(log, column, first, facts.steps.get(column, 0.0))
    if found is None:
        return
    present, begin, least = found
    if len(present) - begin < thresholds.ANSWER_ROWS:
        return
    off = _off(log, bound, column, np.arange(len(log.t_s)) >= present[begin], first, least)
    if off.tells:
        yield dead_end(log, name, column, present, begin, f"{off.told(unit_of(column) or '')}: the sensor was not read")


def _off(log: RunLog, bound: BoundPlant, column: str, stands: Rows, first: int, least: float) -> _Off:
    """How far the plant is off behind a row in which the output rests, in its `stands` (n,) and elsewhere from row `first` on; 0 where the
    log does not tell."""
    back, ahead = (
        int(thresholds.DEAD_ROWS),
        max(thresholds.FORETOLD_ROWS, round(thresholds.FORETOLD_S / log.sample_period_s)),
    )
    nothing = _Off(0.0, 0.0, ahead * log.sample_period_s)
    values, rows = log.column(column), np.arange(first + back, len(log.t_s) - ahead)
    rests = np.abs(values[rows] - values[rows - back]) <= least
    known = np.isfinite(log.y[rows] + log.y[rows - back]).all(axis=1) & np.isfinite(values[rows + ahead])
    # Until then the states that no sensor reads are not known.
    rows = rows[rests & known & (log.t_s[rows] > log.t_s[first] + thresholds.RUN_UP_S)]
    here = _some(rows[stands[rows - back] & stands[rows] & stands[rows + ahead]])
    elsewhere = _some(rows[~stands[rows] & ~stands[rows + ahead]])
    if not len(here) or len(elsewhere) < thresholds.LEAST_ANSWERS:
        return nothing
    off = _off_behind(log, bound, column, np.concatenate([here, elsewhere]), ahead)
    if not np.isfinite(off).all():
        return nothing
    least_off = thresholds.BROKEN_OFF_STEPS * least
    return replace(nothing, here=float(off[: len(here)].max()), elsewhere=max(float(off[len(here) :].max()), least_off))


def _some(rows: Places) -> Places:
    """So many of the rows, evenly."""
    return rows[:: max(1, len(rows) // int(thresholds.ROWS_ASKED))]


def _off_behind(log: RunLog, bound: BoundPlant, column: str, rows: Places, ahead: int) -> Array:
    """How far the plant, from its axes as they are read in each row and the other states as the inputs make them, is from what is read
    `ahead` rows later."""
    back_s = thresholds.DEAD_ROWS * log.sample_period_s
    read = {name: log.column(name) for name in log.columns.outputs}
    at = {name: (y[rows], (y[rows] - y[rows - thresholds.DEAD_ROWS]) / back_s) for name, y in read.items()}
    model = read_ahead(log, bound, column, rows, with_axes_as_read(bound, states_along(log, bound)[rows], at), ahead)
    return np.asarray(np.abs((np.inf if model is None else model) - log.column(column)[rows + ahead]))
