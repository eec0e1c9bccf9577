"""The nonlinear helicopter with dry friction and encoder steps, flown by any law, compiled or written in Python."""

import ctypes
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium
from sim.simulate import CController, Conditions, simulate

SAMPLE_PERIOD_S = 0.01

# The manoeuvre of the published figures: elevation -30 -> 30 -> -20 in steps of 10 to 30 deg, azimuth 0/30/-30/60/0.
ELEVATION_DEG = ((0, -30), (10, -20), (18, -10), (26, 0), (34, 10), (42, 20), (50, 30), (65, 10), (75, -20), (85, 0))
AZIMUTH_DEG = ((0, 0), (14, 30), (30, -30), (60, 60), (80, 0))
DURATION_S = 95.0


class PythonLaw(Protocol):
    def reset(self, psi_rad: float, phi_rad: float) -> None: ...

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]: ...


@dataclass(frozen=True)
class Flown:
    """Samples: time, inputs (n, 2) in V, true angles and references (n, 2) in deg."""

    t_s: np.ndarray
    u_V: np.ndarray
    angle_deg: np.ndarray
    reference_deg: np.ndarray

    @property
    def saturated(self) -> float:
        """Share of samples with an input at its limit."""
        return float(np.mean((self.u_V[:, 0] <= 0.0) | (self.u_V[:, 0] >= 10.0) | (np.abs(self.u_V[:, 1]) >= 10.0)))

    def mean_error_deg(self, axis: int) -> float:
        """Mean distance of angle and unfiltered reference."""
        return float(np.mean(np.abs(self.angle_deg[:, axis] - self.reference_deg[:, axis])))

    def overshoot(self, axis: int) -> np.ndarray:
        """For each step of an axis' reference: how far the angle passes it before the next one, as a share of the step."""
        return np.array([self._overshoot(axis, begin, end) for begin, end in self._holds(axis)[1:]])

    def _overshoot(self, axis: int, begin: int, end: int) -> float:
        reference = self.reference_deg[:, axis]
        step = reference[begin] - reference[begin - 1]
        passed = (self.angle_deg[begin:end, axis] - reference[begin]) / step
        return max(0.0, float(np.max(passed)))

    def steady_error_deg(self, axis: int) -> np.ndarray:
        """For each hold of an axis' reference: distance of its last second's mean angle from it."""
        angle, reference = self.angle_deg[:, axis], self.reference_deg[:, axis]
        return np.array([abs(np.mean(angle[end - 100 : end]) - reference[end - 1]) for _, end in self._holds(axis)])

    def _holds(self, axis: int) -> list[tuple[int, int]]:
        changes = np.flatnonzero(np.diff(self.reference_deg[:, axis])) + 1
        edges = [0, *changes.tolist(), len(self.t_s)]
        return list(pairwise(edges))


def profile(t_s: np.ndarray, points: tuple[tuple[float, float], ...], rate_deg_s: float | None = None) -> np.ndarray:
    """Steps of (time, angle), or ramps between them at `rate_deg_s`, starting from rest at the first angle."""
    times, angles = zip(*points, strict=True)
    steps = np.array(angles, dtype=float)[np.searchsorted(times, t_s, side="right") - 1]
    if rate_deg_s is None:
        return steps
    ramped = steps.copy()
    for k in range(1, len(ramped)):
        largest = rate_deg_s * SAMPLE_PERIOD_S
        ramped[k] = ramped[k - 1] + np.clip(steps[k] - ramped[k - 1], -largest, largest)
    return ramped


def manoeuvre(duration_s: float = DURATION_S, rate_deg_s: float | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) and references (n, 2) in deg."""
    t_s = np.arange(round(duration_s / SAMPLE_PERIOD_S)) * SAMPLE_PERIOD_S
    columns = [profile(t_s, points, rate_deg_s) for points in (ELEVATION_DEG, AZIMUTH_DEG)]
    return t_s, np.stack(columns, axis=1)


def fly(
    bound: BoundPlant,
    law: ControllerTable | PythonLaw,
    t_s: np.ndarray,
    reference_deg: np.ndarray,
    *,
    start_deg: float | None = -30.0,
) -> Flown:
    """Fly from rest at elevation start_deg, or from the lower stop with rotors at rest where that is None."""
    x0 = np.zeros(6) if start_deg is None else equilibrium(bound, math.radians(start_deg)).x0
    if start_deg is None:
        x0[1] = -bound.parameter("Psi_lim")
    drive = law if isinstance(law, ControllerTable) else _compiled_call(law)
    runs = simulate(bound, t_s, x0, drive, Conditions(reference=np.radians(reference_deg)))
    assert runs.u is not None
    assert runs.x is not None
    return Flown(t_s, runs.u, np.degrees(runs.x[:, [1, 4]]), reference_deg)


_CALL = ctypes.CFUNCTYPE(
    None,
    ctypes.c_void_p,
    ctypes.POINTER(ctypes.c_double),
    ctypes.POINTER(ctypes.c_double),
    ctypes.POINTER(ctypes.c_double),
)
_KEPT_ALIVE: list[object] = []


def _compiled_call(law: PythonLaw) -> CController:
    """A Python law where the kernel wants the address of a C function; it is reset with the first sample."""
    started = False

    def call(_: int, reference: object, y: object, u: object) -> None:
        nonlocal started
        if not started:
            law.reset(y[0], y[1])  # type: ignore[index]
            started = True
        u[0], u[1] = law.step(reference[0], reference[1], y[0], y[1])  # type: ignore[index]

    function = _CALL(call)
    _KEPT_ALIVE.append(function)
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None
    return CController(address)
