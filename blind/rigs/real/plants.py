"""The plants of the real rigs: what each is called in a log, how large things are on it, its numbers from a plant file."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from blind.simulation.ce150 import Rig
from records.errors import BadInput

FOLDER = Path(__file__).resolve().parents[3] / "plants"
MODELS = ("ce150", "aeroshield", "emps", "quanser_aero")  # the numbers of rig.h
FURTHEST_SD = 2.5
LEAST_SHARE = 0.05  # of a stated value: what is positive stays so


@dataclass(frozen=True)
class RealPlant:
    """A plant: its model's name and what people call it, names of its axes, inputs, outputs and drives (`rotors`) with the columns of
    their speeds; what is usual on it.

    By axis: torque (N m; N), inertia (kg m^2; kg), rate (rad/s; m/s) and angle (rad; m) that a run reaches; by input: its size in V.
    `busy`: the share of it that flights come to.
    `limits`: parameters of the least and the largest command, None for the largest negated; `stops`: of the stops.
    `hides`: by axis the parameter that dry friction is, if it has one. `gravity`: the axis that gravity turns.
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
    limits: tuple[tuple[str | None, str], ...]
    stops: tuple[str, ...] = ()
    hides: tuple[str, ...] = ()
    gravity: str = ""
    busy: float = 0.6

    @property
    def path(self) -> Path:
        """Its plant file."""
        return FOLDER / f"{self.name}.toml"

    @property
    def sensors(self) -> tuple[str, ...]:
        """Places of the readings: psi_sensor of psi_rad."""
        return tuple(f"{output.rpartition('_')[0]}_sensor" for output in self.outputs)

    def read(self, text: str, where: str) -> Rig:
        """The rig of a plant file's text; raises BadInput for another model."""
        content = tomllib.loads(text)
        if content.get("model") != self.name:
            raise BadInput("model", where, repr(content.get("model")), repr(self.name), "give a file of that plant")
        entries = content["parameters"]
        return Rig(
            values={name: np.atleast_1d(np.asarray(entry["value"], float)) for name, entry in entries.items()},
            sds={name: np.atleast_1d(np.asarray(entry["sd"], float)) for name, entry in entries.items()},
            resolution_rad=tuple(_resolution(content["sensors"][output]) for output in self.outputs),
        )

    def fields(self, rig: Rig) -> dict[str, Any]:
        """The content of the C structure rig_t."""
        own = {name: value.tolist() if len(value) > 1 else float(value[0]) for name, value in rig.values.items()}
        low, high = zip(*(self.range_V(rig, i) for i in range(len(self.inputs))), strict=True)
        return {
            "plant": MODELS.index(self.name),
            "axes": len(self.axes),
            "inputs": len(self.inputs),
            "low_V": [*low, 0.0][:2],
            "high_V": [*high, 0.0][:2],
            "stop": [*(rig.value(name) for name in self.stops), 0.0, 0.0][:2],
            self.name: own,
        }

    def range_V(self, rig: Rig, i: int) -> tuple[float, float]:
        """Least and largest command of an input, V."""
        low, high = self.limits[i]
        if low == "0":
            return 0.0, rig.value(high)
        return (-rig.value(high) if low is None else rig.value(low)), rig.value(high)


def _resolution(entry: Mapping[str, Any]) -> float:
    return float(next(value for name, value in entry.items() if name.startswith("resolution_")))


CE150 = RealPlant(
    name="ce150",
    rig="CE150",
    axes=("elevation", "azimuth"),
    inputs=("u_M_V", "u_T_V"),
    outputs=("psi_rad", "phi_rad"),
    drives=("main_input", "tail_input"),
    rotors=("main_rotor", "tail_rotor"),
    speeds=("omega_M_rad_s", "omega_T_rad_s"),
    torque=(0.04, 0.04),
    inertia=(0.0044, 0.0041),
    rate=(0.5, 0.8),
    reach=(0.35, 0.9),
    input_V=(10.0, 10.0),
    limits=(("u_min", "u_max"), ("uT_min", "uT_max")),
    stops=("Psi_lim", "Phi_lim"),
    hides=("b_cE", "b_cA"),
    gravity="elevation",
)
AEROSHIELD = RealPlant(
    name="aeroshield",
    rig="AeroShield",
    axes=("arm",),
    inputs=("u_V",),
    outputs=("theta_rad",),
    drives=("input",),
    rotors=("rotor",),
    speeds=(),
    torque=(0.004,),
    inertia=(5e-5,),
    rate=(2.0,),
    reach=(0.6,),
    input_V=(3.7,),
    limits=(("0", "u_max"),),
    gravity="arm",
)
EMPS = RealPlant(
    name="emps",
    rig="EMPS",
    axes=("carriage",),
    inputs=("u_V",),
    outputs=("q_m",),
    drives=("input",),
    rotors=("motor",),
    speeds=(),
    torque=(100.0,),
    inertia=(95.0,),
    rate=(0.1,),
    reach=(0.1,),
    input_V=(10.0,),
    limits=((None, "u_max"),),
    busy=0.25,
)
QUANSER_AERO = RealPlant(
    name="quanser_aero",
    rig="Quanser Aero",
    axes=("pitch", "yaw"),
    inputs=("u_M_V", "u_T_V"),
    outputs=("theta_rad", "psi_rad"),
    drives=("main_input", "tail_input"),
    rotors=("main_rotor", "tail_rotor"),
    speeds=(),
    torque=(0.015, 0.015),
    inertia=(0.018, 0.018),
    rate=(0.3, 0.5),
    reach=(0.2, 0.35),
    input_V=(24.0, 24.0),
    limits=((None, "u_max"), (None, "u_max")),
    gravity="pitch",
)
PLANTS = (CE150, AEROSHIELD, EMPS, QUANSER_AERO)


def draw_stated(
    plant: RealPlant, given: Rig, denied: Sequence[str], rng: Generator
) -> tuple[Rig, Mapping[tuple[str, str], str]]:
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
    return Rig(rig.values, {**sds, **zero}, rig.resolution_rad), stated


def draw_true(known: Rig, rng: Generator) -> Rig:
    """Each number normal with its stated sd within 2.5 sd, and none loses its sign."""
    drawn = {}
    for name, values in known.values.items():
        moved = values + known.sds[name] * np.clip(rng.standard_normal(values.shape), -FURTHEST_SD, FURTHEST_SD)
        drawn[name] = np.where(moved * np.sign(values) < LEAST_SHARE * np.abs(values), LEAST_SHARE * values, moved)
    return known.with_values(drawn)
