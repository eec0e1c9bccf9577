"""How many Runge-Kutta steps a sample of a flight takes: as many as the plant's own fastest motion needs."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from records.errors import BadInput
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from sim.kernel.reference import reference

# RK4 follows exp(-a h) up to a h = 2.79 before its answer grows; a tenth is left for what a rate changes by along a flight.
LARGEST_STEP = 2.5
# Long before, the answer decays at another rate, by 1.9 % at a h = 1, 0.08 % at 0.5 and 0.004 % at 0.25: a log that was flown in one step a
# sample, read in finer ones, told of a stage of 2000 rad/s sampled at 2 kHz that it has 1961.6 +- 0.2. So a motion that can be told within
# a sample is followed this closely, and what is told of it is right to 0.1 sd of such a log.
ACCURATE_STEP = 0.25
SETTLED_WITHIN = 40.0  # a sample of so many time constants; LARGEST_STEP leaves a thousandth of what began it: nothing is told of that
MOST_SUBSTEPS = (
    1000  # of 10 ms: a time constant of 4 us; an amplifier's own is shorter, and no part of a plant that moves
)


def fastest_rad_s(bound: BoundPlant, x0: ArrayLike) -> float:
    """The largest |eigenvalue| of the equations' slopes at x0 (states,), inputs in the middle of their range; 0 where they have none."""
    nominal = without_effects(bound)
    model = nominal.model
    x = np.asarray(x0, dtype=float)[: len(model.states)]
    u = np.array([np.mean(nominal.commands(variable)) for variable in model.inputs])
    with np.errstate(all="ignore"):
        A: NDArray[np.float64] = reference(model).A(0.0, x, u, nominal.p, np.zeros(len(model.axes)))
    return float(np.max(np.abs(np.linalg.eigvals(A)))) if np.all(np.isfinite(A)) else 0.0


def steps_a_stretch(bound: BoundPlant, rate_rad_s: float, stretch_s: float) -> int:
    """The fewest steps of a stretch of time in which `rate_rad_s` is followed; raises BadInput where MOST_SUBSTEPS are too few."""
    constants = rate_rad_s * stretch_s
    longest = ACCURATE_STEP if constants <= SETTLED_WITHIN else LARGEST_STEP
    needed = max(1, math.ceil(constants / longest))
    if needed > MOST_SUBSTEPS:
        raise BadInput(
            f"plant of {bound.plant.model}",
            "simulation",
            f"a motion of {rate_rad_s:.2g} rad/s, which takes {needed} steps in {1e3 * stretch_s:g} ms",
            f"{MOST_SUBSTEPS} steps a sample at most",
            "leave out a state that is so fast: put its settled value in its place",
        )
    return needed
