"""A sensor whose range ends within its axis' way, where the readings alone do not show it: what stands there foretells what follows worse
than no reading does.

An axis that rests, is stopped or held leaves from where it stood, and its readings say so; one that went on unseen comes back with the
speed and from where the plant takes it. So the likelihood of the rows behind a stand at an output's greatest or least reading is asked
twice: after all that was read, and after all but the stand.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.columns import fitted_or_none
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import EffectLibrary, effect_library
from logcheck import thresholds
from logcheck.facts import plant_facts
from logcheck.stands.column import runs
from logcheck.stretches import part
from records.log import RunLog
from records.reasons import Note
from records.text.units import unit_of
from sim.added_effects import without_effects
from sim.bind import BoundPlant

Array = NDArray[np.float64]
RANGE_BEFORE_ROWS = 400  # before a stand, by which the plant's state and numbers are known: time
RANGE_BEHIND_ROWS = 30  # behind a stand, in which what an axis did unseen still shows
Rows = NDArray[np.bool_]


@dataclass(frozen=True)
class RangeEnd:
    """The greatest or least reading of an output at which its sensor ends: its place and level, and what is to be said."""

    place: int
    level: float
    note: Note


@dataclass(frozen=True)
class _Extreme:
    """The greatest or least reading of an output, and how others would go on from it."""

    place: int
    column: str
    level: float
    how: str


@dataclass(frozen=True)
class _Stand:
    log: int
    first: int
    last: int


def range_ends(
    bound: BoundPlant, logs: Sequence[RunLog], used: Sequence[Rows | None], names: Sequence[str]
) -> Iterator[RangeEnd]:
    """The ends of ranges at which an output of the logs stood, as the plant without added effects foretells, by PLAIN_TO_SEE nats."""
    bound = without_effects(bound)
    library = effect_library(bound)
    for extreme in _extremes(bound, logs):
        stands = _longest(logs, extreme)
        foretold = ((at, _misled(library, bound, logs[at.log], used[at.log], extreme.place, at)) for at in stands)
        found = next(((stand, nats) for stand, nats in foretold if nats > decisions.PLAIN_TO_SEE), None)
        if found is not None:
            where = found[0].log
            yield RangeEnd(extreme.place, extreme.level, _note(extreme, logs[where], names[where], *found))


def within_ranges(log: RunLog, ends: Sequence[RangeEnd]) -> RunLog:
    """The log without the readings at the ends of ranges."""
    y = log.y.copy()
    for end in ends:
        y[y[:, end.place] == end.level, end.place] = np.nan
    return replace(log, y=y) if ends else log


def _extremes(bound: BoundPlant, logs: Sequence[RunLog]) -> Iterator[_Extreme]:
    """Both of each output that moves, but one beside a stop of its axis: there it ends its way."""
    stops = plant_facts(bound).stops
    for place, column in enumerate(bound.model.outputs):
        read = [log.column(column)[np.isfinite(log.column(column))] for log in logs]
        every = np.concatenate(read) if read else np.zeros(0)
        if not every.size or every.min() == every.max():
            continue
        low, high = stops.get(column, (-np.inf, np.inf))
        for level, how in ((float(every.max()), "exceeds"), (float(every.min()), "falls below")):
            if low + thresholds.BEYOND_STOP_rad < level < high - thresholds.BEYOND_STOP_rad:
                yield _Extreme(place, column, level, how)


def _longest(logs: Sequence[RunLog], extreme: _Extreme) -> list[_Stand]:
    """The longest stands at an extreme to which the output comes from afar, and from which it goes as far."""
    columns = [log.column(extreme.column) for log in logs]
    found = [
        _Stand(number, first, last)
        for number, values in enumerate(columns)
        for first, last in runs(values)
        if values[first] == extreme.level
        and last - first + 1 >= decisions.RANGE_STAND_ROWS
        and _is_far(values, first, last)
    ]
    return sorted(found, key=lambda stand: stand.first - stand.last)[: decisions.most_asked()]


def _is_far(values: Array, first: int, last: int) -> bool:
    """Whether the output is CUT_OFF_STEPS of its least moves away in the rows before the stand and in those behind: on a coarser grid than
    its plant file states, a step by itself is what no reading foretells."""
    moves = np.abs(np.diff(values))
    far = thresholds.CUT_OFF_STEPS * float(np.min(moves, initial=np.inf, where=moves > 0.0))
    sides = (
        values[max(0, first - RANGE_BEHIND_ROWS) : first],
        values[last + 1 : last + 1 + RANGE_BEHIND_ROWS],
    )
    return all(np.max(np.abs(side - values[first]), initial=0.0, where=np.isfinite(side)) >= far for side in sides)


def _misled(
    library: EffectLibrary, bound: BoundPlant, log: RunLog, used: Rows | None, place: int, stand: _Stand
) -> float:
    """By how many nats the rows behind a stand are less likely after all was read than after all but what is at its level."""
    rows = np.arange(max(0, stand.first - RANGE_BEFORE_ROWS), stand.last + 1 + RANGE_BEHIND_ROWS)
    near = part(log, slice(int(rows[0]), int(rows[-1]) + 1))
    before, at_end = rows <= stand.last, log.y[rows, place] == log.y[stand.first, place]
    kept = (np.ones(len(rows), bool) if used is None else used[rows]) & (before | ~at_end)
    unseen = kept & ~at_end

    def case_of(mask: Rows) -> Case:
        return make_case(library, [near], [mask], bound)

    found = fitted_or_none(case_of(unseen), plain_fit)
    if found is None:
        return 0.0
    behind = [
        likelihood_of(case_of(mask), found.hypothesis) - likelihood_of(case_of(mask & before), found.hypothesis)
        for mask in (unseen, kept)
    ]
    return behind[0] - behind[1]


def _note(extreme: _Extreme, log: RunLog, name: str, stand: _Stand, misled: float) -> Note:
    column = extreme.column
    numbers = {
        "level": extreme.level,
        "start_s": float(log.t_s[stand.first]),
        "end_s": float(log.t_s[stand.last]),
        "nats": misled,
    }
    level = f"{extreme.level:.5g} {unit_of(column) or ''}"
    said = (
        f"{name}: {column} never {extreme.how} {level}, where it stands from {numbers['start_s']:.6g} s to "
        f"{numbers['end_s']:.6g} s: without these readings the plant foretells what follows {misled:.0f} nats better: the sensor's range "
        "ends there; left out"
    )
    return Note("clipped_sensor", name, numbers, said)
