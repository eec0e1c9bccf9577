"""Exact derivatives of one run of a whole plant."""

import numpy as np

from sim.bind import BoundPlant
from sim.runs.sensitivities import Sensitivities, sensitivities, whole
from sim.start import start_state


def slopes(
    bound: BoundPlant, t_s: np.ndarray, u: np.ndarray, x0: np.ndarray, columns: tuple[str, ...]
) -> Sensitivities:
    """One window over all rows, with the plant's own parameters; states of effects that x0 lacks begin at rest."""
    return sensitivities(bound.model, whole(t_s, u, start_state(bound, x0)), bound.p, columns)
