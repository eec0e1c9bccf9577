"""How slow a plant is: what the rigs of the table do in a second, a heated body does in half a minute.

Where nothing moves but currents, temperatures or levels, a model must predict as long as its fastest of them takes,

(1)  second_s = 2^n,  the power of two nearest to 1 / |lambda|,  1 at least

lambda the largest eigenvalue of the equations' slopes by the states, where each output is of its usual size and each input half its
largest. In powers of two, a re-tune of the parameters hardly ever changes it. A mass on a bench moves within a second, whatever drives it.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import sympy

from records.plant import Plant
from sim.model import Model

Known = tuple[tuple[str, tuple[float, ...]], ...]


def at_its_pace(model: Model, plant: Plant) -> Model:
    """The model with the plant's `second_s`: itself where that is a second, and the same object for the same numbers."""
    if model.axes or not model.states:
        return model
    known = {name: entry.values for name, entry in plant.parameters.items()}
    return _paced(model, tuple(sorted(known.items())))


@lru_cache(maxsize=256)
def _paced(model: Model, known: Known) -> Model:
    second_s = _second_s(model, dict(known))
    return model if second_s == 1.0 else _slow(model, second_s)


@lru_cache(maxsize=64)
def _slow(model: Model, second_s: float) -> Model:
    return replace(model, second_s=second_s)


def _second_s(model: Model, known: dict[str, tuple[float, ...]]) -> float:
    """Eq (1); 1 where numbers are missing or too many, of which `bind` tells."""
    at = dict.fromkeys(model.states, 0.0)
    at |= {
        state: place.size
        for place in model.places.sensors.values()
        if (state := model.outputs[place.output]) in model.states
    }
    for spec in model.parameters:
        at |= dict(zip(spec.symbols, known.get(spec.name, ()), strict=False))
    at |= {place.variable: 0.5 * place.size for place in model.places.inputs.values()}
    slopes = model.state_rates().jacobian(sympy.Matrix(model.states)).xreplace(at)
    try:
        fastest = float(np.max(np.abs(np.linalg.eigvals(np.array(slopes, dtype=float)))))
    except (TypeError, ValueError, np.linalg.LinAlgError):
        return 1.0
    return 2.0 ** max(0, round(math.log2(1.0 / fastest))) if 0.0 < fastest < math.inf else 1.0
