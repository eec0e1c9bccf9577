"""Effects of sensors as the filter takes them: the reading is turned back into what it says of the true output."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput, late, variance_stated
from diagnosis.library.coarse_grid import grid_evidence
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.library.play import behind_play
from diagnosis.library.reading_spans import UniformError, charge, less_sure
from sim.effect import Values
from sim.paths.output_stages import OutputDelay, OutputLag, OutputSteps, Play
from sim.paths.path import OutputStage

Array = NDArray[np.float64]
Row = TypeVar("Row")
# To both sides, in the plant's seconds, over which a rate is taken: long enough for an encoder's steps, short for a helicopter.
RATE_S = 0.05


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
    span_s = RATE_S * library.bound.model.second_s
    return late(unsure_when(filter_input, stage.output, stage.jitter_s, stated, span_s), stage.output, stage.tau_s)


def _unlagged(_: EffectLibrary, filter_input: FilterInput, stage: OutputLag) -> FilterInput:
    return late(filter_input, stage.output, stage.tau_s)


def _unrounded(library: EffectLibrary, filter_input: FilterInput, stage: OutputSteps) -> FilterInput:
    return _coarser(filter_input, stage.output, stage.q, library.bound.plant.sensors[library.outputs[stage.output]])


def _through_play(library: EffectLibrary, filter_input: FilterInput, stage: Play) -> FilterInput:
    step = library.bound.plant.sensors.get(library.outputs[stage.output], 0.0)
    return behind_play(filter_input, stage.output, stage.width, step)


def unsure_when(
    filter_input: FilterInput, output: int, jitter_s: float, stated: float, span_s: float = RATE_S
) -> FilterInput:
    """The filter input whose readings of an output are true at an instant that is known to `jitter_s` only: r + (dy/dt jitter)^2, the rate
    over `span_s` to both sides.

    What the readings showed of noise beyond the variance that is `stated` is no more than that then, as far as its mean goes.
    """
    seen = np.flatnonzero(np.isfinite(filter_input.read[:, output]))
    if jitter_s <= 0.0 or not len(seen):
        return filter_input
    r = filter_input.r.copy()
    further = (rates(filter_input.t_s[seen], filter_input.read[seen, output], span_s) * jitter_s) ** 2
    known = min(max(filter_input.single[output] - stated, 0.0), float(np.mean(further)))
    r[seen, output] += further - filter_input.standing[seen, output] * known
    return replace(filter_input, r=r)


def rates(t_s: Array, read: Array, span_s: float) -> Array:
    """How fast readings (n,) at the instants t_s (n,) change, in their unit per second, over `span_s` to both sides; 0 of a single one."""
    before = np.searchsorted(t_s, t_s - span_s)
    behind = np.minimum(np.searchsorted(t_s, t_s + span_s), len(t_s) - 1)
    passed_s = t_s[behind] - t_s[before]
    return np.divide(read[behind] - read[before], passed_s, out=np.zeros(len(t_s)), where=passed_s > 0.0)


def _coarser(filter_input: FilterInput, output: int, grid: float, step: float) -> FilterInput:
    """The filter input where an output lies on a coarser grid: what readings say is read anew, and its evidence is that of the grid."""
    seen = np.flatnonzero(np.isfinite(filter_input.y[:, output]))  # none of an axis that is held
    y, r = filter_input.y.copy(), filter_input.r.copy()
    y[seen, output] = filter_input.read[seen, output]
    r[seen, output] = filter_input.standing[seen, output] * filter_input.single[output]
    of_grid = grid_evidence(filter_input.read[:, output], grid, step)
    plain = replace(filter_input, y=y, r=r)
    error = UniformError(grid, charge(filter_input, output, grid), of_grid)
    return less_sure(plain, output, seen, filter_input.standing[seen, output], error)


# What a filter makes of the readings behind each kind of stage: (library, filter input, stage) -> filter input.
READ_BACK: Mapping[type, Callable[[EffectLibrary, FilterInput, Any], FilterInput]] = {
    OutputDelay: _on_time,
    OutputLag: _unlagged,
    OutputSteps: _unrounded,
    Play: _through_play,
}
