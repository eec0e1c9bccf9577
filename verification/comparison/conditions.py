"""Plants that are not as designed for: every uncertain parameter within +-10 %, and each effect that a diagnosis may find."""

import numpy as np
from numpy.typing import NDArray

from sim.added_effects import library, with_effects
from sim.bind import BoundPlant

SPREAD = 0.1

# Effects on each place of the rig, at the size that the library calls one that may be met.
EFFECTS = (
    "main_input.deadzone",
    "tail_input.deadzone",
    "main_input.supply_sag",
    "main_input.lag",
    "loop.delay",
    "main_rotor.ground_effect",
    "main_rotor.warmup",
    "elevation.coulomb",
    "elevation.centre_of_gravity",
    "elevation.weight_shift",
    "elevation.cable_spring",
    "azimuth.coulomb",
    "azimuth.cable_spring",
    "azimuth.tilt",
    "azimuth.rotor_acceleration",
    "psi_sensor.backlash",
)


def spread(bound: BoundPlant, runs: int, seed: int) -> NDArray[np.float64]:
    """Parameter vectors (runs, parameters): each parameter with a sd above 0 times a factor of its own, uniform in 0.9..1.1.

    A polynomial's coefficients share one factor. What the plant file calls exact (sd = 0) stays.
    """
    rng = np.random.default_rng([seed, 10])
    p = np.tile(bound.p, (runs, 1))
    column = 0
    for spec in bound.model.parameters:
        if np.any(bound.sd[column : column + spec.count] > 0.0):
            p[:, column : column + spec.count] *= rng.uniform(1.0 - SPREAD, 1.0 + SPREAD, (runs, 1))
        column += spec.count
    return p


def with_effect(bound: BoundPlant, name: str) -> BoundPlant:
    """The plant with one effect at its reference size."""
    effect = library(bound)[name]
    return with_effects(bound, {name: {parameter.symbol: parameter.reference for parameter in effect.parameters}})
