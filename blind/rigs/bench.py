"""What a case is made on: a plan, a drawn rig with the place where it flies, and the kinds of rig that can be drawn."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.effects.effect import Catalogue, Effect
from blind.simulation.ce150 import DRY_FRICTION, Rig
from blind.simulation.flight import RunInputs
from blind.simulation.record import Loss, Model, Record

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Plan:
    """What a case is to hold: its effects with a wanted severity each."""

    kind: str
    effects: tuple[Effect, ...]
    targets: tuple[float, ...]
    excited: bool
    rotor_speeds: bool


class Lab(Protocol):
    """Where one drawn rig flies: its simulation, its controller, its manoeuvres."""

    @property
    def jitter(self) -> bool:
        """Whether the rows come at irregular times."""

    def inputs(self, rng: Generator, loss: Loss, run: int | None) -> RunInputs:
        """What the run of that number from 0 is given; a short trial for None."""

    def fly(self, model: Model, shadows: Sequence[Model], inputs: RunInputs) -> Record:
        """One closed-loop run; each shadow runs freely for a second at a time."""

    def predict(self, rig: Rig, record: Record, step_s: float) -> Array:
        """Free runs of an effect-free rig on a record's commands, anew from its apparent state each second; angles (n,
        2) in rad."""


@dataclass(frozen=True)
class Logging:
    """How runs become files: nominal period and length, time of the first row, noise and steps of the rotor speeds."""

    period_s: float
    length_s: float
    start_s: float
    speed_noise_rad_s: float
    speed_step_rad_s: float


@dataclass(frozen=True, eq=False)
class Bench:
    """The rig as stated, the rig as it is (without effects), where it flies, its training runs, how they are logged.

    `restated`: (table, key) -> value, what this case's plant file states otherwise than the one that was given.
    """

    nominal: Rig
    true: Rig
    lab: Lab
    training: int
    logging: Logging
    restated: Mapping[tuple[str, str], str]


@dataclass(frozen=True)
class RigKind:
    """What cases of one kind are made of."""

    catalogue: Catalogue
    draw_bench: Callable[[Rig, Plan, Generator], Bench]


def denied_parameters(plan: Plan, rng: Generator) -> list[str]:
    """Parameters that the case's plant file states as 0, sorted: those that its effects are, and now and then dry friction that the rig has
    not either, as an absent term alone must tell nothing."""
    denied = [effect.hides for effect in plan.effects if effect.hides]
    return sorted(denied + [name for name in DRY_FRICTION if rng.random() < 0.1 and name not in denied])


def needs_reversal(plan: Plan) -> bool:
    """Whether an effect shows only where the tail rotor turns the other way."""
    return any(effect.needs == "reversal" for effect in plan.effects)
