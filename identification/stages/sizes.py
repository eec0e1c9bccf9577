"""Where the parameters of logs may lie; one that is absent from a plant file (value and sd 0) is sized by what it would do to them."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from identification.fit.ranges import Range, ranges_of
from identification.runs.prediction import blocks
from identification.runs.run import Run, coefficient_names, offset_names
from records.log import RunLog
from sim.bind import BoundPlant

Array = NDArray[np.float64]
ABSENT_SHARE = 0.1  # an absent parameter is taken to matter a tenth as much as the others
START_OF_ABSENT = 1e-9  # a friction of exactly 0 has no slope: it does not act at all
REACH, BOUND = 100.0, 1e-3


def ranges_of_logs(
    bound: BoundPlant,
    logs: Mapping[str, RunLog],
    coarse: Sequence[Run],
    names: Sequence[str],
    limits: Mapping[str, tuple[float, float]],
    offsets: bool,
) -> dict[str, Range]:
    """Where each parameter may lie; one of value and sd 0 gets its size from what it would do to these logs."""
    ranges = ranges_of(bound, tuple(dict.fromkeys(names)), limits)
    places = {name: place for place, name in enumerate(coefficient_names(bound.model))}
    absent = [
        name for name in ranges if not bound.p[places[name]] and not bound.sd[places[name]] and name not in limits
    ]
    if offsets:
        ranges |= _offset_ranges(bound, logs)
    return with_sizes(coarse, ranges, absent)


def with_sizes(runs: Sequence[Run], ranges: Mapping[str, Range], absent: Sequence[str]) -> dict[str, Range]:
    """The ranges with size, bounds and, for what cannot be negative, a start above 0 for the parameters `absent`.

    The size is that at which the parameter moves the readings by `ABSENT_SHARE` of what the other parameters do at theirs.
    """
    if not absent:
        return dict(ranges)
    names = tuple(ranges)
    start = np.array([START_OF_ABSENT if name in absent else ranges[name].start for name in names])
    effect = np.zeros(len(names))
    for run in runs:
        for block in blocks(run, names, start):
            effect += np.sum(block.by_parameter**2, axis=0)
    effect = np.sqrt(effect)
    others = [effect[k] * ranges[name].scale for k, name in enumerate(names) if name not in absent]
    common = ABSENT_SHARE * float(np.median(others)) if others else 1.0
    found = dict(ranges)
    for name in absent:
        own = effect[names.index(name)]
        size = common / own if own > 0.0 else ranges[name].scale
        found[name] = _range(ranges[name], float(size))
    return found


def _range(old: Range, size: float) -> Range:
    """Bounds of the user stay as they are: only those that were a guess, multiples of the old size, move."""
    never_negative = old.lower >= 0.0
    lower = BOUND * size if never_negative else -REACH * size
    return Range(size if never_negative else 0.0, lower, REACH * size, size)


def _offset_ranges(bound: BoundPlant, logs: Mapping[str, RunLog]) -> dict[str, Range]:
    """An input's offset lies within so much as the input itself moves."""
    spread = np.maximum(np.max([np.std(log.u, axis=0) for log in logs.values()], axis=0), 1e-9)
    return {
        name: Range(0.0, -5.0 * float(size), 5.0 * float(size), float(size))
        for name, size in zip(offset_names(bound.model), spread, strict=True)
    }
