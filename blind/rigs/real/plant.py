"""A plant of the real rigs: what it is called in a log, how large things are on it; its numbers from a plant file, and how they are
drawn."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from blind.simulation.ce150 import Rig
from records.errors import BadInput

FOLDER = Path(__file__).resolve().parents[3] / "plants"
MODELS = ("ce150", "aeroshield", "emps", "quanser_aero", "antx_2dof_drone", "dc_motor")  # the numbers of rig.h
FURTHEST_SD = 2.5
LEAST_SHARE = 0.05  # of a stated value: what is positive stays so


@dataclass(frozen=True)
class Colours:
    """Names of the spectra that errors are drawn from: of what pushes the axes, and of each output's readings; () for what rigs share."""

    push: tuple[str, ...] = ()
    reading: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True)
class RealPlant:
    """A plant: its model's name and what people call it, names of its axes, inputs, outputs and drives (`rotors`, () where the input is
    all there is) with the columns of their speeds; what is usual on it. Outputs are the axes' angles, then the first one's rate where a
    gyro measures that.

    By axis: torque (N m; N; rad/s^2 where the equations are scaled to an inertia of 1), inertia (kg m^2; kg), rate (rad/s; m/s) and angle
    (rad; m) that a run reaches; by input: its size in V, or in its own unit. `busy`: the share of it that flights come to; limits are at
    most `severest` times as low. `detail`: by axis the angle over which sensors and detents change, where that is no run's reach.
    `limits`: of the least and the largest command, a parameter or a number, None for the largest negated; `stops`: of the stops.
    `hides`: by axis the parameter that dry friction is, if it has one. `gravity`: the axis that gravity turns.
    `proportional`: thrust is stated so, over inputs that flights use the most of; `signed`: two rotors against one another give it;
    `blades`: it comes from blades that may stall.
    `uneven`: friction may be so by direction; without any stated the library's formula would be a constant force.
    `linear`: without friction, one input moves what one sensor shows: what the one does and the other cannot be told apart.
    `lost`: the angle at which nobody believes a run. `longest_step_s`: what its quickest part lets a prediction take.
    `equations`: the file of its own equations, beside a plant file in a folder of its own. `colours`: of its disturbances, and by output of
    its reading errors; those of other rigs where it has none.
    """

    name: str
    rig: str
    axes: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    drives: tuple[str, ...]
    rotors: tuple[str, ...]
    speeds: tuple[str, ...]
    torque: tuple[float, ...]
    inertia: tuple[float, ...]
    rate: tuple[float, ...]
    reach: tuple[float, ...]
    input_V: tuple[float, ...]
    limits: tuple[tuple[str | float | None, str | float], ...]
    stops: tuple[str, ...] = ()
    hides: tuple[str, ...] = ()
    gravity: str = ""
    busy: float = 0.6
    severest: float = 30.0
    detail: tuple[float, ...] = ()
    proportional: bool = False
    signed: bool = False
    blades: bool = True
    uneven: bool = True
    linear: bool = False
    lost: float = 100.0
    longest_step_s: float = 1.0
    equations: str = ""
    colours: Colours = Colours()

    @property
    def path(self) -> Path:
        """Its plant file."""
        return FOLDER / self.name / "plant.toml" if self.equations else FOLDER / f"{self.name}.toml"

    @property
    def beside(self) -> tuple[Path, ...]:
        """What its plant file needs beside it."""
        return (self.path.with_name(self.equations),) if self.equations else ()

    @property
    def sensors(self) -> tuple[str, ...]:
        """Places of the axes' readings: psi_sensor of psi_rad."""
        return tuple(f"{angle}_sensor" for angle in self.angles)

    @property
    def angles(self) -> tuple[str, ...]:
        """Outputs of the axes without their unit."""
        return tuple(output.rpartition("_")[0] for output in self.outputs[: len(self.axes)])

    def fine(self, i: int) -> float:
        """The angle of an axis over which sensors and detents change."""
        return self.detail[i] if self.detail else self.reach[i]

    def behind(self, what: str) -> str:
        """What a drive has, as it would be called of the one sensor where that is the same."""
        return f"{self.sensors[0]}.{what}" if self.linear else ""

    def before(self, what: str) -> str:
        """What the one sensor has, as it would be called of the drive where that is the same."""
        return f"{self.drives[0]}.{what}" if self.linear else ""

    def read(self, text: str, where: str) -> Rig:
        """The rig of a plant file's text; raises BadInput for another model."""
        content = tomllib.loads(text)
        key, own = ("equations", self.equations) if self.equations else ("model", self.name)
        if content.get(key) != own:
            raise BadInput(key, where, repr(content.get(key)), repr(own), "give a file of that plant")
        entries = content["parameters"]
        return Rig(
            values={name: np.atleast_1d(np.asarray(entry["value"], float)) for name, entry in entries.items()},
            sds={name: np.atleast_1d(np.asarray(entry["sd"], float)) for name, entry in entries.items()},
            resolution_rad=tuple(_stated(content["sensors"][output], "resolution_") for output in self.outputs),
            noise=tuple(_stated(content["sensors"][output], "noise_") for output in self.outputs),
        )

    def fields(self, rig: Rig) -> dict[str, Any]:
        """The content of the C structure rig_t."""
        own = {name: value.tolist() if len(value) > 1 else float(value[0]) for name, value in rig.values.items()}
        low, high = zip(*(self.range_V(rig, i) for i in range(len(self.inputs))), strict=True)
        return {
            "plant": MODELS.index(self.name),
            "axes": len(self.axes),
            "outputs": len(self.outputs),
            "inputs": len(self.inputs),
            "low_V": [*low, 0.0][:2],
            "high_V": [*high, 0.0][:2],
            "lost": self.lost,
            "stop": [*(rig.value(name) for name in self.stops), 0.0, 0.0][:2],
            self.name: own,
        }

    def range_V(self, rig: Rig, i: int) -> tuple[float, float]:
        """Least and largest command of an input, V."""
        low, high = self.limits[i]
        largest = _limit(rig, high)
        return (-largest if low is None else _limit(rig, low)), largest


def _limit(rig: Rig, limit: str | float) -> float:
    return rig.value(limit) if isinstance(limit, str) else limit


def _stated(entry: Mapping[str, Any], kind: str) -> float:
    """Of a sensor, 0 where nothing is stated."""
    return float(next((value for name, value in entry.items() if name.startswith(kind)), 0.0))


def draw_stated(given: Rig, denied: Sequence[str], rng: Generator) -> tuple[Rig, Mapping[tuple[str, str], str]]:
    """(the rig as stated, what its plant file says otherwise): each spread 2 to 5 % of its value, in one case of four 5 to 15 %.

    Conventions and limits, of sd 0, stay exact; `denied` are stated as 0.
    """
    low, high = (0.05, 0.15) if rng.random() < 0.25 else (0.02, 0.05)
    sds = {}
    for name, values in given.values.items():
        share = float(rng.uniform(low, high))
        known = given.sds[name] == 0.0
        sds[name] = np.array([float(f"{sd:.4g}") for sd in np.where(known, 0.0, share * np.abs(values))])
    stated = {
        (f"parameters.{name}", "sd"): repr(values.tolist() if len(values) > 1 else float(values[0]))
        for name, values in sds.items()
        if values.any() and name not in denied
    }
    for name in denied:
        stated |= {(f"parameters.{name}", key): "0.0" for key in ("value", "sd")}
    zero = {name: np.zeros(1) for name in denied}
    rig = given.with_values(zero)
    return replace(rig, sds={**sds, **zero}), stated


def draw_true(known: Rig, rng: Generator) -> Rig:
    """Each number normal with its stated sd within 2.5 sd, and none loses its sign."""
    drawn = {}
    for name, values in known.values.items():
        moved = values + known.sds[name] * np.clip(rng.standard_normal(values.shape), -FURTHEST_SD, FURTHEST_SD)
        drawn[name] = np.where(moved * np.sign(values) < LEAST_SHARE * np.abs(values), LEAST_SHARE * values, moved)
    return known.with_values(drawn)
