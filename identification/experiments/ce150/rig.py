"""The rig that the simulated experiments are performed on: true parameters in a simulation of its own, and encoders."""

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.bind import BoundPlant
from toolchain.host import STRICT_FLOAT_FLAGS, build_shared, load_shared

Array = NDArray[np.float64]
FOLDER = Path(__file__).parent
PERIOD_S = 0.01
SUBSTEPS = 10  # per sample of 10 ms
STATES = (
    "omega_M_rad_s",
    "psi_rad",
    "psi_dot_rad_s",
    "omega_T_rad_s",
    "phi_rad",
    "phi_dot_rad_s",
    "turn_M_rad",
    "turn_T_rad",
)
PSI, PHI, TURN_M, TURN_T = 1, 4, 6, 7


@dataclass(frozen=True)
class Setup:
    """How the rig stands: fields of rig_setup in rig.h."""

    mount_rad: float = 0.0
    turned: float = 0.0
    elevation_locked: int = 0
    azimuth_locked: int = 0
    hand_turned: int = 0
    hand_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    hand_rad_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    hand_phase_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    weight_kg: float = 0.0
    lever_m: float = 0.0
    lever_rad: float = 0.0


@dataclass(frozen=True, eq=False)
class Rig:
    """A rig with the true parameters of `truth`, standing as `setup` says."""

    truth: BoundPlant
    setup: Setup = field(default_factory=Setup)

    def run(self, x: ArrayLike, u: ArrayLike, t_s: float = 0.0, period_s: float = PERIOD_S) -> Array:
        """True states (n + 1, 8) in the order of `STATES` from x (8,), with inputs u (n, 2) held for a period each."""
        ffi, lib = _library()
        inputs = np.ascontiguousarray(np.vstack([u, np.asarray(u)[-1:]]), dtype=float)
        state, history = np.array(x, dtype=float), np.empty((len(inputs), len(STATES)))
        steps = max(1, round(SUBSTEPS * period_s / PERIOD_S))
        truth, setup = _struct(ffi, "rig_truth", self._parameters()), _struct(ffi, "rig_setup", vars(self.setup))
        pointers = [ffi.cast("double *", array.ctypes.data) for array in (inputs, state, history)]
        lib.rig_run(truth, setup, len(inputs), steps, t_s, period_s, *pointers)
        return history

    def encoder(self, output: str, angle_rad: Array) -> Array:
        """Angles as the encoder of an output shows them."""
        step = self.truth.plant.sensors[output]
        return np.asarray(np.round(angle_rad / step) * step)

    def _parameters(self) -> dict[str, Any]:
        parameters = self.truth.plant.parameters
        names = [field.strip(" ;").split("[")[0] for field in _fields("rig_truth")]
        return {name: parameters[name].value for name in names}


def _fields(name: str) -> list[str]:
    """Field names of a struct of doubles in rig.h, in order."""
    ffi, _ = _library()
    return [field for field, _ in ffi.typeof(name).fields]


def _struct(ffi: Any, name: str, values: Any) -> Any:
    made = ffi.new(f"{name} *")
    for key, value in dict(values).items():
        setattr(made, key, value)
    return made


@cache
def _library() -> tuple[Any, Any]:
    header = FOLDER / "rig.h"
    path = build_shared("experiment-rig", [header, FOLDER / "rig.c"], include_dirs=[FOLDER], flags=STRICT_FLOAT_FLAGS)
    declared = [line for line in header.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return load_shared("\n".join(declared), path)
