"""Runs of a plant: with given inputs or with a controller in the loop, one or many side by side."""

import numpy as np
from numpy.typing import ArrayLike

from sim.bind import BoundPlant
from sim.runs.compiled_run import PLAIN, CController, Conditions, Drive, Noise, Runs, run_equations
from sim.runs.on_the_way import run_loop, run_open
from sim.start import start_state

__all__ = ["CController", "Conditions", "Drive", "Noise", "Runs", "simulate"]


def simulate(bound: BoundPlant, t_s: ArrayLike, x0: ArrayLike, drive: Drive, under: Conditions = PLAIN) -> Runs:
    """Sample the plant at t_s (n,) from x0 (states,) or (runs, states).

    `drive` makes the inputs: an array (n, inputs), or (runs, n, inputs); the float64 law of a controller table; or compiled code. The
    last two need a reference. Inputs are held from t_s[k] to t_s[k + 1]. Dry friction and stops are located events. Raises BadInput for
    shapes that do not fit.

    An x0 that lacks the states of added effects starts those at rest. Where effects act on the way of a signal, a loop is closed
    sample by sample in Python, single and without noise.
    """
    given = start_state(bound, x0)
    if not bound.input_path and not bound.output_path:
        return run_equations(bound, t_s, given, drive, under)
    if isinstance(drive, np.ndarray):
        return run_open(bound, t_s, given, drive, under)
    return run_loop(bound, t_s, given, drive, under)
