"""Effects of sensors as the filter takes them: the reading is turned back into what it says of the true output."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput, late, variance_stated
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.library.lattice import grid_evidence
from sim.effect import Values
from sim.paths.output_stages import OutputDelay, OutputLag, OutputSteps, Play
from sim.paths.path import OutputStage

Array = NDArray[np.float64]
Row = TypeVar("Row")
# A reading behind play says that the axis lies within it, no more: as a bell of the same variance an interval costs ln sqrt(12 / 2 pi).
BELL = 0.32
RATE_S = 0.05  # to both sides, over which a reading's rate is taken: long enough for an encoder's steps, short for a helicopter


def sensed(library: EffectLibrary, filter_input: FilterInput, effects: Mapping[str, Values]) -> FilterInput:
    """The filter input under the sensor effects among `effects`: what each reading says of the true output.

    A delay puts the reading back to when it was true, a lag likewise by its time constant; steps make it less certain; behind play the
    axis is half the play further the way it last moved, and anywhere within it while the reading stands. Raises NotImplementedError for
    a stage that READ_BACK does not know.
    """
    for name, values in effects.items():
        on_output = library.effects[name].on_output
        if on_output is not None:
            stage = on_output(values)
            filter_input = row_for(READ_BACK, stage, "READ_BACK of diagnosis/library/sensor_effects.py")(
                library, filter_input, stage
            )
    return filter_input


def row_for(table: Mapping[type, Row], stage: OutputStage, where: str) -> Row:
    """The row of a table by kind of stage; raises NotImplementedError, which says where one is missing."""
    if type(stage) not in table:
        known = ", ".join(kind.__name__ for kind in table)
        raise NotImplementedError(
            f"{where} has no row for the stage {type(stage).__name__}, only for {known}: add what a diagnosis makes of it"
        )
    return table[type(stage)]


def _on_time(library: EffectLibrary, filter_input: FilterInput, stage: OutputDelay) -> FilterInput:
    stated = variance_stated(library.bound.plant, library.outputs[stage.output])
    return late(unsure_when(filter_input, stage.output, stage.jitter_s, stated), stage.output, stage.tau_s)


def _unlagged(_: EffectLibrary, filter_input: FilterInput, stage: OutputLag) -> FilterInput:
    return late(filter_input, stage.output, stage.tau_s)


def _unrounded(library: EffectLibrary, filter_input: FilterInput, stage: OutputSteps) -> FilterInput:
    return _coarser(filter_input, stage.output, stage.q, library.bound.plant.sensors[library.outputs[stage.output]])


def _through_play(_: EffectLibrary, filter_input: FilterInput, stage: Play) -> FilterInput:
    return behind_play(filter_input, stage.output, stage.width)


def unsure_when(filter_input: FilterInput, output: int, jitter_s: float, stated: float) -> FilterInput:
    """The filter input whose readings of an output are true at an instant that is known to `jitter_s` only: r + (dy/dt jitter)^2.

    What the readings showed of noise beyond the variance that is `stated` is no more than that then, as far as its mean goes.
    """
    seen = np.flatnonzero(np.isfinite(filter_input.read[:, output]))
    if jitter_s <= 0.0 or not len(seen):
        return filter_input
    r = filter_input.r.copy()
    further = (rates(filter_input.t_s[seen], filter_input.read[seen, output]) * jitter_s) ** 2
    known = min(max(filter_input.single[output] - stated, 0.0), float(np.mean(further)))
    r[seen, output] += further - filter_input.standing[seen, output] * known
    return replace(filter_input, r=r)


def rates(t_s: Array, read: Array) -> Array:
    """How fast readings (n,) at the instants t_s (n,) change, in their unit per second, over RATE_S to both sides; 0 of a single one."""
    before = np.searchsorted(t_s, t_s - RATE_S)
    behind = np.minimum(np.searchsorted(t_s, t_s + RATE_S), len(t_s) - 1)
    passed_s = t_s[behind] - t_s[before]
    return np.divide(read[behind] - read[before], passed_s, out=np.zeros(len(t_s)), where=passed_s > 0.0)


def _coarser(filter_input: FilterInput, output: int, grid: float, step: float) -> FilterInput:
    """The filter input where an output lies on a coarser grid: what readings say is read anew, and its evidence is that of the grid."""
    seen = np.flatnonzero(np.isfinite(filter_input.read[:, output]))
    y, r = filter_input.y.copy(), filter_input.r.copy()
    y[:, output] = filter_input.read[:, output]
    r[seen, output] = filter_input.standing[seen, output] * filter_input.single[output]
    evidence = grid_evidence(filter_input.read[:, output], grid, step)
    plain = replace(filter_input, y=y, r=r)
    return _less_sure(
        plain, output, seen, grid, evidence - _once(filter_input, output, seen) * _charge(filter_input, output, grid)
    )


def behind_play(filter_input: FilterInput, output: int, width: float) -> FilterInput:
    """The filter input where an output's readings follow it behind play of that width."""
    y = filter_input.y.copy()
    seen = np.flatnonzero(np.isfinite(y[:, output]))
    moved = np.append(0.0, np.diff(filter_input.read[seen, output]))
    last = np.maximum.accumulate(np.where(moved != 0.0, np.arange(len(moved)), 0))
    unsure = standing_rows(filter_input, output)
    y[seen, output] += np.where(np.isin(seen, unsure), 0.0, 0.5 * width * np.sign(moved[last]))
    charge = min(BELL, _charge(filter_input, output, width))
    return _less_sure(replace(filter_input, y=y), output, unsure, width, -_once(filter_input, output, unsure) * charge)


def _less_sure(
    filter_input: FilterInput, output: int, rows: NDArray[np.int64], span: float, known: float
) -> FilterInput:
    """The filter input where the readings of `rows` may be off by anything within `span`, which is charged with
    `known` instead of by each row."""
    r = filter_input.r.copy()
    r[rows, output] += filter_input.standing[rows, output] * span**2 / 12.0
    counted = _counted(filter_input, output, rows)
    each = 0.5 * float(np.sum(np.log(r[counted, output] / filter_input.r[counted, output])))
    return replace(filter_input, r=r, known=filter_input.known + each + known)


def _counted(filter_input: FilterInput, output: int, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Those rows whose readings count in the likelihood."""
    return np.asarray(rows[filter_input.place[rows, output] >= 0])


def _charge(filter_input: FilterInput, output: int, span: float) -> float:
    """What a reading that may be off by anything within `span` costs in likelihood."""
    return 0.5 * float(np.log1p(span**2 / 12.0 / filter_input.single[output]))


def _once(filter_input: FilterInput, output: int, rows: NDArray[np.int64]) -> float:
    """How many readings `rows` hold where the same count, read again and again, is one."""
    return float(np.sum(1.0 / filter_input.standing[_counted(filter_input, output, rows), output]))


def standing_rows(filter_input: FilterInput, output: int) -> NDArray[np.int64]:
    """Instants at which an axis behind play may be anywhere within it: the reading has not changed for longer than it usually takes, or
    changes back next.
    """
    seen = np.flatnonzero(np.isfinite(filter_input.y[:, output]))
    moved = np.append(0.0, np.diff(filter_input.read[seen, output]))
    changes = np.flatnonzero(moved != 0.0)
    if len(changes) < 3:
        return seen
    rows = np.arange(len(moved))
    before = np.clip(np.searchsorted(changes, rows, side="right") - 1, 0, len(changes) - 1)
    after = np.minimum(before + 1, len(changes) - 1)
    standing = rows - changes[before]
    turns = (np.sign(moved[changes[before]]) != np.sign(moved[changes[after]])) & (standing > 0)
    unsure = turns | (standing < 0) | (standing > 2.0 * float(np.median(np.diff(changes))))
    return np.asarray(seen[unsure])


# What a filter makes of the readings behind each kind of stage: (library, filter input, stage) -> filter input.
READ_BACK: Mapping[type, Callable[[EffectLibrary, FilterInput, Any], FilterInput]] = {
    OutputDelay: _on_time,
    OutputLag: _unlagged,
    OutputSteps: _unrounded,
    Play: _through_play,
}
