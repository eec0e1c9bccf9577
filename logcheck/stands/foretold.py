"""An output that stands to the log's end though the plant, from where it stands, foretells that it moves: its sensor was no longer read.

How far to trust the plant is asked of the log itself: wherever else the output rests, the plant says where it is a little later, and is
off by so much at most. So friction that the plant lacks, a wrong weight and an unknown wind count for nothing.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.ahead import read_ahead, states_along, with_axes_as_read
from logcheck.facts import PlantFacts
from logcheck.finding import EXCLUDE, Array, Finding, Found, Rows
from logcheck.stands.standing import RUN_UP_S, last_stand
from records.log import RunLog
from records.text.units import unit_of
from sim.bind import BoundPlant

Places = NDArray[np.int64]


def foretold_findings(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts, begins: Rows) -> Iterator[Found]:
    """The last stand of each axis' output that the plant foretells to move; `begins` (n,) as for dead stretches."""
    first = int(np.max(np.flatnonzero(begins), initial=0))
    ahead = max(thresholds.FORETOLD_ROWS, round(thresholds.FORETOLD_S / log.sample_period_s))
    for column in sorted(facts.positions):
        found = last_stand(log, column, first, facts.steps.get(column, 0.0))
        if found is None:
            continue
        present, begin, least = found
        values = log.column(column)[present]
        if len(present) - begin < max(thresholds.ANSWER_ROWS, ahead + thresholds.DEAD_ROWS + 1):
            continue
        here, elsewhere = _missed(log, bound, column, present[begin], first, ahead, least)
        if here <= thresholds.FORETOLD_TIMES * elsewhere or here < thresholds.LEAST_MOTION_STEPS * least:
            continue
        unread: Rows = np.zeros(len(log.t_s), bool)
        unread[present[begin + 1 :]] = True
        span, unit = (float(log.t_s[present[begin]]), float(log.t_s[present[-1]])), unit_of(column) or ""
        sentence = (
            f"{column} stands at {values[begin]:.4g} from {span[0]:.6g} s to the end, where the plant foretells that it moves by "
            f"{here:.2g} {unit} within {ahead * log.sample_period_s:.2g} s; where it rests elsewhere the plant is off by {elsewhere:.2g} "
            f"{unit} at most: the sensor was not read; left out"
        )
        yield Found(Finding("dead_end", name, column, *span, sentence, EXCLUDE, int(unread.sum())), unread)


def _missed(
    log: RunLog, bound: BoundPlant, column: str, begin: int, first: int, ahead: int, least: float
) -> tuple[float, float]:
    """By how much the plant is off `ahead` rows behind a row in which the output rests, at most: in the last stand, from row `begin` on,
    and elsewhere; (0, 0) where the log does not tell."""
    values, rows = log.column(column), np.arange(first + thresholds.DEAD_ROWS, len(log.t_s) - ahead)
    rests = np.abs(values[rows] - values[rows - thresholds.DEAD_ROWS]) <= least
    known = np.isfinite(log.y[rows] + log.y[rows - thresholds.DEAD_ROWS]).all(axis=1) & np.isfinite(
        values[rows + ahead]
    )
    rows = rows[rests & known]
    early = log.t_s[first] + RUN_UP_S  # until then the states that no sensor reads are not known
    here = _some(rows[rows >= begin + thresholds.DEAD_ROWS])
    elsewhere = _some(rows[(rows < begin - ahead) & (log.t_s[rows] > early)])
    if not len(here) or len(elsewhere) < thresholds.LEAST_ANSWERS:
        return 0.0, 0.0
    off = _off(log, bound, column, np.concatenate([here, elsewhere]), ahead)
    if not np.isfinite(off).all():
        return 0.0, 0.0
    return float(off[: len(here)].max()), max(float(off[len(here) :].max()), thresholds.BROKEN_OFF_STEPS * least)


def _some(rows: Places) -> Places:
    """So many of the rows, evenly."""
    return rows[:: max(1, len(rows) // int(thresholds.ASKED))]


def _off(log: RunLog, bound: BoundPlant, column: str, rows: Places, ahead: int) -> Array:
    """How far the plant, from its axes as they are read in each row and the other states as the inputs make them, is from what is read
    `ahead` rows later."""
    back_s = thresholds.DEAD_ROWS * log.sample_period_s
    read = {name: log.column(name) for name in log.columns.outputs}
    at = {name: (y[rows], (y[rows] - y[rows - thresholds.DEAD_ROWS]) / back_s) for name, y in read.items()}
    model = read_ahead(log, bound, column, rows, with_axes_as_read(bound, states_along(log, bound)[rows], at), ahead)
    return np.asarray(np.abs((np.inf if model is None else model) - log.column(column)[rows + ahead]))
