"""What a case is made on: a plan, a drawn rig with the place where it flies, and the kinds of rig that can be drawn."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.effects.effect import Catalogue, Effect
from blind.simulation.ce150 import DRY_FRICTION, Rig, read_rig
from blind.simulation.record import Loss, Model, Record

Array = NDArray[np.float64]
FILTERED = "angles filtered"  # what is odd about logs whose readings come late by somebody's filter


@dataclass(frozen=True)
class Plan:
    """What a case is to hold: its effects with a wanted severity each."""

    kind: str
    effects: tuple[Effect, ...]
    targets: tuple[float, ...]
    excited: bool
    rotor_speeds: bool


class Lab(Protocol):
    """Where one drawn rig flies: its simulation, its controller, its manoeuvres; what it gives as inputs it takes to fly."""

    @property
    def jitter(self) -> bool:
        """Whether the rows come at irregular times."""

    def inputs(self, rng: Generator, loss: Loss, run: int | None) -> Any:
        """What the run of that number from 0 is given; a short trial for None."""

    def fly(self, model: Model, shadows: Sequence[Model], inputs: Any) -> Record:
        """One closed-loop run; each shadow runs freely for a second at a time."""

    def predict(self, rig: Rig, record: Record, step_s: float) -> Array:
        """Free runs of an effect-free rig on a record's commands, anew from its apparent state each second; angles (n,
        2) in rad."""


@dataclass(frozen=True)
class Columns:
    """What a plant and the columns of its logs are called: inputs, outputs, speeds where they are logged; what people call the rig."""

    plant: str = "ce150"
    rig: str = "CE150"
    inputs: tuple[str, ...] = ("u_M_V", "u_T_V")
    outputs: tuple[str, ...] = ("psi_rad", "phi_rad")
    speeds: tuple[str, ...] = ("omega_M_rad_s", "omega_T_rad_s")


@dataclass(frozen=True)
class Logging:
    """How runs become files: nominal period and length, time of the first row, noise and steps of the rotor speeds."""

    period_s: float
    length_s: float
    start_s: float
    speed_noise_rad_s: float
    speed_step_rad_s: float


GRAVITY = (("m", "l", "g"), ("dx", "g", "me"), ("tau_gE",))  # whose product plant files state it as


@dataclass(frozen=True, eq=False)
class Bench:
    """The rig as stated, the rig as it is (without effects), where it flies, its training runs, how they are logged.

    `restated`: (table, key) -> value, what this case's plant file states otherwise than the one that was given; `faults`: what is odd
    about its logs, in words; `each_shows`: whether every one of several effects has to show in the logs as it did in its trial.
    """

    nominal: Rig
    true: Rig
    lab: Lab
    training: int
    logging: Logging
    restated: Mapping[tuple[str, str], str]
    columns: Columns = Columns()
    faults: tuple[str, ...] = ()
    each_shows: bool = False

    @property
    def gravity_Nm(self) -> float:
        """Gravity's moment about the arm's bearing; 0 where the plant file has none of that name."""
        stated = (names for names in GRAVITY if self.true.values.keys() >= set(names))
        return next((math.prod(self.true.value(name) for name in names) for names in stated), 0.0)


def with_word(column: str, word: str) -> str:
    """A column's name with a word before its unit: psi_rad, ref: psi_ref_rad; q_rad_s: q_ref_rad_s."""
    whole = column.removesuffix("_s") if column.endswith(("_rad_s", "_m_s")) else column
    name, _, unit = whole.rpartition("_")
    return f"{name}_{word}_{unit}{column.removeprefix(whole)}"


CE150_FILE = Path(__file__).resolve().parents[2] / "plants" / "ce150.toml"


@dataclass(frozen=True)
class RigKind:
    """What cases of one kind on one plant are made of; `plant`: its plant file as it is given, read by `read` (text, where); `beside`:
    files that a case's plant file needs beside it."""

    catalogue: Catalogue
    draw_bench: Callable[[Rig, Plan, Generator], Bench]
    plant: Path = CE150_FILE
    read: Callable[[str, str], Rig] = read_rig
    beside: tuple[Path, ...] = ()


def denied_parameters(plan: Plan, rng: Generator) -> list[str]:
    """Parameters that the case's plant file states as 0, sorted: those that its effects are, and now and then dry friction that the rig has
    not either, as an absent term alone must tell nothing."""
    denied = [effect.hides for effect in plan.effects if effect.hides]
    return sorted(denied + [name for name in DRY_FRICTION if rng.random() < 0.1 and name not in denied])


def needs_reversal(plan: Plan) -> bool:
    """Whether an effect shows only where the tail rotor turns the other way."""
    return any(effect.needs == "reversal" for effect in plan.effects)
