"""An axis that is held does not move: all of its readings are of one angle, and beside that they tell of the sensor alone."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput
from diagnosis.library.effect_library import EffectLibrary

Array = NDArray[np.float64]


def with_held(
    library: EffectLibrary, filter_input: FilterInput, x0: Array, p0: Array, locked: Collection[str]
) -> tuple[FilterInput, Array, Array]:
    """The filter input, start x0 and its variances p0 (states,) with each `locked` axis at the mean of its readings, at rest and known.

    Its readings then count no more: a count that noise tips to and fro is no motion, and neither a lag nor a delay of it could be seen.
    """
    x0, p0, y = x0.copy(), p0.copy(), filter_input.y.copy()
    states, outputs = library.states, library.bound.model.outputs
    for axis in library.bound.model.axes:
        if axis.name not in locked:
            continue
        speed = states.index(str(axis.velocity))
        x0[speed], p0[speed] = 0.0, 0.0
        for name, expression in outputs.items():
            column = library.outputs.index(name)
            read = filter_input.read[:, column]
            if expression == axis.position and np.isfinite(read).any():
                place = states.index(str(axis.position))
                x0[place], p0[place] = float(np.nanmean(read)), 0.0
                y[:, column] = np.nan
    return replace(filter_input, y=y), x0, p0
