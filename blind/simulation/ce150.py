"""The CE150 as this benchmark knows it: numbers read from a plant file, drawn within their stated spread."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from records.errors import BadInput

Array = NDArray[np.float64]

# Names of the plant file -> (field of rig_t, index); polynomials go to a whole row.
PLACES: Mapping[str, tuple[str, int]] = {
    "p_bM": ("damping", 0),
    "p_bT": ("damping", 1),
    "K_M": ("drive", 0),
    "K_T": ("drive", 1),
    "p_FM": ("thrust", 0),
    "p_FT": ("thrust", 1),
    "l_M": ("arm_m", 0),
    "l_T": ("arm_m", 1),
    "J_E": ("inertia", 0),
    "J_A": ("inertia", 1),
    "b_vE": ("viscous", 0),
    "b_vA": ("viscous", 1),
    "b_cE": ("coulomb_Nm", 0),
    "b_cA": ("coulomb_Nm", 1),
    "u_min": ("u_min_V", 0),
    "u_max": ("u_max_V", 0),
    "uT_min": ("u_min_V", 1),
    "uT_max": ("u_max_V", 1),
    "Psi_lim": ("stop_rad", 0),
    "Phi_lim": ("stop_rad", 1),
}
SCALARS: Mapping[str, str] = {"tau_gE": "gravity_Nm", "K_E": "gyro", "K_A": "reaction"}
OTHERS = ("g", "cf_sign", "cf_length")
DRY_FRICTION = ("b_cE", "b_cA")


@dataclass(frozen=True)
class Rig:
    """Parameters of a plant file by name (arrays; one element for a number), in SI units, with the encoders' steps in rad; by output
    also the white noise before them, 0 or () where none is stated."""

    values: Mapping[str, Array]
    sds: Mapping[str, Array]
    resolution_rad: tuple[float, ...]
    noise: tuple[float, ...] = ()

    def value(self, name: str) -> float:
        """A parameter that is one number."""
        return float(self.values[name][0])

    def with_values(self, changes: Mapping[str, Array]) -> "Rig":
        """The same rig with some parameters replaced."""
        return replace(self, values={**self.values, **changes})

    def fields(self) -> dict[str, Any]:
        """The content of the C structure rig_t, field by field."""
        rows: dict[str, list[list[float]]] = {}
        for name, (field, index) in PLACES.items():
            rows.setdefault(field, [[], []])[index] = [float(x) for x in self.values[name]]
        fields: dict[str, Any] = {
            name: value if len(value[0]) > 1 else [value[0][0], value[1][0]] for name, value in rows.items()
        }
        fields |= {field: self.value(name) for name, field in SCALARS.items()}
        # Seed 000 eq (8): tau_gE / (2 g), times a length, with a sign of its own.
        length = self.value("cf_sign") * self.value("cf_length")
        fields["centrifugal"] = length * self.value("tau_gE") / (2.0 * self.value("g"))
        fields["resolution_rad"] = list(self.resolution_rad)
        return fields


def read_rig(text: str, where: str) -> Rig:
    """The rig of a plant file's text; raises BadInput when it is no CE150 or lacks a parameter."""
    content = tomllib.loads(text)
    if content.get("model") != "ce150":
        raise BadInput("model", where, repr(content.get("model")), "'ce150'", "the sealed benchmark flies this model")
    needed = (*PLACES, *SCALARS, *OTHERS)
    missing = [name for name in needed if name not in content["parameters"]]
    if missing:
        raise BadInput("parameters", where, f"no {missing[0]}", "all of the model's", "give a whole plant file")
    entries = content["parameters"]
    steps = content["sensors"]
    return Rig(
        values={name: np.atleast_1d(np.asarray(entries[name]["value"], float)) for name in needed},
        sds={name: np.atleast_1d(np.asarray(entries[name]["sd"], float)) for name in needed},
        resolution_rad=(steps["psi_rad"]["resolution_rad"], steps["phi_rad"]["resolution_rad"]),
    )


def load_rig(path: Path, read: Callable[[str, str], Rig] = read_rig) -> tuple[Rig, str]:
    """The rig of a plant file, by `read` from (text, where), and the file's text; raises BadInput."""
    try:
        text = path.read_text(encoding="utf-8")
        return read(text, str(path)), text
    except OSError as error:
        raise BadInput("plant file", str(path), error.strerror or "", "a readable file", "check the path") from error
    except tomllib.TOMLDecodeError as error:
        raise BadInput("plant file", str(path), f"no TOML ({error})", "a TOML file", "mend that line") from error


def draw_rig(nominal: Rig, rng: Generator) -> Rig:
    """A rig within the stated spread: each number normal with its sd, no further out than 2.5 sd; friction stays above 0."""
    drawn = {}
    for name, value in nominal.values.items():
        deviation = np.clip(rng.standard_normal(value.shape), -2.5, 2.5)
        drawn[name] = value + nominal.sds[name] * deviation
    for name in DRY_FRICTION:
        drawn[name] = np.maximum(drawn[name], 0.1 * nominal.values[name])
    return nominal.with_values(drawn)


def uncertain(nominal: Rig) -> list[tuple[str, int, float]]:
    """Every number that is not known exactly: (name, index, sd)."""
    return [(name, index, float(sd)) for name, sds in nominal.sds.items() for index, sd in enumerate(sds) if sd > 0.0]


def stated_zero(names: Sequence[str]) -> dict[tuple[str, str], str]:
    """What a plant file states of absent parameters, value and sd 0: (table, key) -> value, for `restated`."""
    return {(f"parameters.{name}", key): "0.0" for name in names for key in ("value", "sd")}


def restated(text: str, changes: Mapping[tuple[str, str], str]) -> str:
    """The plant file's text with some values replaced: (table, key) -> value; the comment behind a replaced one goes."""
    lines, table = [], ""
    for line in text.split("\n"):
        if line.startswith("["):
            table = line[1:].partition("]")[0]
        key = line.split("=")[0].strip()
        value = changes.get((table, key))
        lines.append(line if value is None else f"{key} = {value}")
    return "\n".join(lines)
