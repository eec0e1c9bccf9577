"""Plants that are not as designed for: every uncertain parameter within +-10 %, and each effect that a diagnosis may find."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from design.structure import missing
from records.errors import BadInput
from sim.added_effects import library, with_effects
from sim.bind import BoundPlant

SPREAD = 0.1

# Effects on each place of the helicopter, at the size that the library calls one that may be met.
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


def effects_of(bound: BoundPlant, wanted: Sequence[str] | None) -> tuple[str, ...]:
    """The effects to be added one at a time: those that are wanted, else the helicopter's of EFFECTS, or all that another plant may have.

    Raises BadInput for one that this plant cannot have.
    """
    known = tuple(library(bound))
    if wanted is None:
        return tuple(name for name in EFFECTS if name in known) if not missing(bound) else known
    for name in wanted:
        if name not in known:
            expected = f"one of {', '.join(known)}"
            raise BadInput("effect", f"plant {bound.plant.name!r}", name, expected, "choose others with --effects")
    return tuple(wanted)


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
