"""A part of a plant bound to the plant's own numbers."""

from collections.abc import Mapping

import numpy as np

from sim.bind import BoundPlant
from sim.model import Model


def subsystem(bound: BoundPlant, model: Model, extra: Mapping[str, float] | None = None) -> BoundPlant:
    """`model` with the coefficients of `bound` by name; `extra` gives those that the plant does not have (a mount's angle)."""
    names = [str(symbol) for symbol in bound.model.parameter_symbols]
    values = {**dict(zip(names, bound.p.tolist(), strict=True)), **(extra or {})}
    sds = dict(zip(names, bound.sd.tolist(), strict=True))
    wanted = [str(symbol) for symbol in model.parameter_symbols]
    p = np.array([values[name] for name in wanted])
    return BoundPlant(bound.plant, model, p, np.array([sds.get(name, 0.0) for name in wanted]))
