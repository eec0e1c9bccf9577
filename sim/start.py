"""Where a run begins: the states of effects beside the plant's own."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.bind import BoundPlant

Array = NDArray[np.float64]


def start_state(bound: BoundPlant, x0: ArrayLike) -> Array:
    """The state (..., states) with what effects brought at rest, from x0 (..., own states); a whole x0 stays as it is."""
    model, given = bound.model, np.asarray(x0, dtype=float)
    own = len(model.states) - len(model.starts)
    if not model.starts or given.ndim == 0 or given.shape[-1] != own:
        return given
    places = {state: place for place, state in enumerate(model.states)}
    columns = [
        given[..., places[start]] if start in places else np.full(given.shape[:-1], float(start))
        for start in model.starts.values()
    ]
    return np.concatenate([given, np.stack(columns, axis=-1)], axis=-1)
