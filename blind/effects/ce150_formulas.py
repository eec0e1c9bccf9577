"""The library's formulas of the contract's table, each brought nearest to a rig's own over the samples that its flights went through.

Where a rig gives no law of its own, its formula is the library's.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blind.effects.effect import Shape
from blind.effects.equivalent import (
    Equivalent,
    Equivalents,
    fitted,
    nearest_rectangle,
    relative,
    scale_of,
    shape_only,
)
from blind.effects.visited import Visited

Array = NDArray[np.float64]
Term = Callable[[float, Shape, Visited], Array]
Start = Callable[[float, Shape, Array], Sequence[float]]

LOWER_STOP_RAD = -np.pi / 4
FULL_RAD_S = 600.0  # what the library's downwash refers the main rotor's speed to


@dataclass(frozen=True, eq=False)
class OwnLaw:
    """A rig's own formula of an effect: its term (amplitude, shape, samples) -> (n,), and where a fit to that starts."""

    term: Term
    start: Start | None = None


@dataclass(frozen=True, eq=False)
class Sized:
    """An effect of amplitude `a` (its field's unit) and a shape, at axis or rotor `index`; the rig's own law of it."""

    a: float
    shape: Shape
    visited: Visited
    index: int
    law: OwnLaw | None = None

    def own(self, a: float) -> Array:
        """The rig's term at an amplitude; raises ValueError where the rig gives none."""
        if self.law is None:
            raise ValueError("a rig's row gives no law, and the library's formula has to be fitted to one")
        return self.law.term(a, self.shape, self.visited)

    def starts(self, target: Array) -> Sequence[float]:
        """Where the fit to a target starts: at the amplitude, unless the rig says otherwise."""
        start = None if self.law is None else self.law.start
        return [self.a] if start is None else start(self.a, self.shape, target)


Formula = Callable[[Sized], Equivalents]


def same(symbol: str, either_sign: bool = False) -> Formula:
    """The rig's number is the library's."""
    return lambda e: {symbol: relative(e.a, either_sign)}


def dead_zone(e: Sized) -> Equivalents:
    """sgn(u) max(|u| - d, 0)."""
    u = e.visited.u(e.index)
    best = fitted(lambda x: np.sign(u) * np.maximum(np.abs(u) - x[0], 0.0) - u, e.own(e.a) - u, [e.a])
    return {"d": relative(best[0])}


def saturation(e: Sized) -> Equivalents:
    """clip(u, -limit, limit); a limit that no sample reaches is the rig's number."""
    u = e.visited.u(e.index)
    out = e.own(e.a)
    if np.array_equal(out, u):
        return {"limit": relative(e.a)}
    best = fitted(lambda x: np.clip(u, -abs(x[0]), abs(x[0])) - u, out - u, e.starts(out))
    return {"limit": relative(abs(best[0]))}


def supply_sag(e: Sized) -> Equivalents:
    """u (1 - s load); term: the share of u that is lost."""
    if e.law is None:
        return {"s": relative(e.a)}
    u, load = e.visited.u(e.index), e.visited.load
    return {"s": relative(scale_of(load * u, e.own(e.a) * u))}


def warm_up(e: Sized) -> Equivalents:
    """a (1 - exp(-t / T)) of the drive is lost."""
    t_s, target = e.visited.t_s, e.own(e.a)
    a, time_s = fitted(lambda x: x[0] * (1.0 - np.exp(-t_s / np.abs(x[1]))), target, e.starts(target))
    return {"a": relative(a), "T": shape_only(abs(time_s), abs(time_s))}


def dry_rotor(e: Sized) -> Equivalents:
    """c sgn(omega)."""
    if e.law is None:
        return {"c": relative(e.a)}
    return {"c": relative(scale_of(np.sign(e.visited.omega(e.index)), e.own(e.a)))}


def ground_effect(e: Sized) -> Equivalents:
    """a exp(-(psi - lower stop) / psi_0) of the thrust is gained."""
    above, target = e.visited.psi - LOWER_STOP_RAD, e.own(e.a)
    a, psi_0 = fitted(lambda x: x[0] * np.exp(-above / np.abs(x[1])), target, e.starts(target))
    return {"a": relative(a), "psi_0": shape_only(abs(psi_0), abs(psi_0))}


def reversed_thrust(e: Sized) -> Equivalents:
    """r F_T for a tail that turns the other way; term: the share of the loss that is there at a speed."""
    back = e.visited.omega_T < -1.0
    share = 1.0
    if e.law is not None and back.any():
        force = e.visited.tail_thrust(e.visited.omega_T[back])
        share = scale_of(force, e.own(1.0)[back] * force)
    return {"r": Equivalent(1.0 + e.a * share, abs(e.a))}


def downwash(e: Sized) -> Equivalents:
    """F_T (1 - a omega_M / 600 rad/s); term: the share of F_T that is lost."""
    x, force = e.visited.omega_M / FULL_RAD_S, e.visited.tail_thrust(e.visited.omega_T)
    return {"a": relative(scale_of(x * force, e.own(e.a) * force))}


def stribeck(e: Sized) -> Equivalents:
    """b_s exp(-(v / v_s)^2)."""
    v, target = np.abs(e.visited.rate(e.index)), e.own(e.a)
    b_s, v_s = fitted(lambda x: x[0] * np.exp(-((v / x[1]) ** 2)), target, e.starts(target))
    return {"b_s": relative(b_s), "v_s": shape_only(abs(v_s), abs(v_s))}


def quadratic_drag(e: Sized) -> Equivalents:
    """c |v| v."""
    v = e.visited.rate(e.index)
    return {"c": relative(e.a * scale_of(v * np.abs(v), e.own(1.0)))}


def cable_spring(e: Sized) -> Equivalents:
    """-k (angle - angle_0)."""
    slope, at_zero = np.polyfit(e.visited.angle(e.index), e.own(e.a), 1)
    return {"k": relative(-slope), "angle_0": shape_only(-at_zero / slope, 0.2)}


def disturbance(e: Sized) -> Equivalents:
    """A rectangle of the same middle; term: the push over the phases 0 to 1 of its time."""
    height, width = nearest_rectangle(e.own(1.0))
    long_s = e.shape["pulse_s"]
    duration_s = width * long_s
    begins_s = e.visited.start_s + e.shape["pulse_start_s"] + 0.5 * (long_s - duration_s)
    return {
        "torque": relative(e.a * height),
        "t_0": shape_only(begins_s, duration_s),
        "duration": shape_only(duration_s, duration_s),
    }


def flexible_mode(omega_n_rad_s: float, zeta: float) -> Equivalents:
    """A mode of the encoder; the library's gain may be defined otherwise and is not judged."""
    return {"omega_n": relative(omega_n_rad_s), "zeta": shape_only(zeta, zeta)}


def sensor_offset(e: Sized) -> Equivalents:
    """angle + offset."""
    return {"offset": relative(e.a if e.law is None else float(e.own(e.a).mean()))}


def sensor_scale(e: Sized) -> Equivalents:
    """scale times angle; term: what is added at an error of 1."""
    error = e.a if e.law is None else e.a * scale_of(e.visited.angle(e.index), e.own(1.0))
    return {"scale": Equivalent(1.0 + error, abs(error))}


def centre_of_gravity(e: Sized) -> Equivalents:
    """cos(psi + delta) in gravity's torque instead of cos(psi); term: their difference."""
    psi = e.visited.psi
    best = fitted(lambda x: np.cos(psi + x[0]) - np.cos(psi), e.own(e.a), [e.a])
    return {"delta": relative(best[0])}


def weight_shift(e: Sized) -> Equivalents:
    """A step of gravity's torque by Delta, at the middle of the time that the rig's weight takes."""
    middle_s = e.visited.start_s + e.shape["weight_time_s"] + 0.5 * e.shape["weight_ramp_s"]
    return {"Delta": relative(e.a * e.visited.gravity_Nm), "t_1": shape_only(middle_s, 1.0)}


def tail_coupling(e: Sized) -> Equivalents:
    """k omega_T |omega_T|."""
    w = e.visited.omega_T
    return {"k": relative(scale_of(w * np.abs(w), e.own(e.a)))}


def tilt(e: Sized) -> Equivalents:
    """m sin(phi - Phi_0); term: the share of it that is left at an elevation."""
    lever = np.sin(e.visited.phi - e.shape["tilt_rad"])
    share = 1.0 if e.law is None else scale_of(lever, e.own(1.0) * lever)
    return {"m": relative(e.a * share), "Phi_0": shape_only(e.shape["tilt_rad"], 0.5)}


def gyroscopic(e: Sized) -> Equivalents:
    """K psi' omega_M sin(psi); term: what stands for the sine."""
    turned = e.visited.psi_dot * e.visited.omega_M
    share = 1.0 if e.law is None else scale_of(turned * np.sin(e.visited.psi), turned * e.own(1.0))
    return {"K": relative(e.a * share)}
