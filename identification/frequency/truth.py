"""The plant that was flown, where it is known: beside what was identified of it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.frequency.lateral import StateSpace
from identification.frequency.match.fit import FrequencyFit
from identification.frequency.models.linear_model import LinearModel, held_response
from identification.results.plant_file import numbers
from records.errors import BadInput
from records.plant import Plant

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Truth:
    """True values by name, the linear model that they give, and its response T (f, outputs, inputs) where a match was made."""

    values: Mapping[str, float]
    of: StateSpace
    T: Complex


def truth_of(plant: Plant, model: LinearModel, fit: FrequencyFit) -> Truth:
    """Of the true `plant`, whose own linear model is `model`; raises BadInput where that rests nowhere near the data."""
    of = model.matrices(model.start)
    if of is None:
        raise BadInput("--truth", plant.name, "no rest where the logs are", "the plant that was flown", "give another")
    values = {name: value for name, (value, _, _) in numbers(plant).items()}
    return Truth(values, of, held_response(of, fit.responses.omega_rad_s, fit.records[0].period_s))
