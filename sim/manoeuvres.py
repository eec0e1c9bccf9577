"""What the references do over a flight: holds, steps and ramps."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Manoeuvre:
    """Sample times t_s (n,), references (n, outputs) in rad, and the plant's state x0 (states,) at t_s[0]."""

    name: str
    t_s: Array
    reference_rad: Array
    x0: Array


@dataclass(frozen=True)
class Leg:
    """From `at_s` on go to `angle_deg`: at once, or as a ramp of `rate_deg_s`, and stay there."""

    at_s: float
    angle_deg: float
    rate_deg_s: float = np.inf


# Each step is left alone for at least 6 s, so that overshoot and steady error of one axis can be read before the next begins.
FLIGHT_ELEVATION = (
    Leg(0.0, -30.0),
    Leg(10.0, -20.0),
    Leg(24.0, -10.0),
    Leg(32.0, 10.0),
    Leg(48.0, 30.0, 5.0),
    Leg(58.0, 0.0, 5.0),
    Leg(78.0, -30.0),
    Leg(96.0, 0.0),
)
FLIGHT_AZIMUTH = (Leg(0.0, 0.0), Leg(16.0, 30.0), Leg(40.0, -30.0), Leg(68.0, 60.0, 20.0), Leg(88.0, 0.0))
FLIGHT_S = 104.0


def flight(bound: BoundPlant, sample_period_s: float = 0.01) -> Manoeuvre:
    """The project's flight: elevation -30..30 deg and azimuth 0/30/-30/60/0 deg in steps and ramps.

    It starts as a rig does: rotors still, the arm on its lower stop, azimuth at 0. For a plant of two outputs.
    """
    axes = zip((FLIGHT_ELEVATION, FLIGHT_AZIMUTH), bound.encoder_steps, strict=True)
    legs = [on_encoder_steps(axis, step_rad) for axis, step_rad in axes]
    return manoeuvre("flight", at_rest(bound), FLIGHT_S, sample_period_s, legs)


def hop(bound: BoundPlant, sample_period_s: float = 0.01) -> Manoeuvre:
    """Eight seconds from rest in the air at -10 deg: both axes move once; for quick checks.

    Raises BadInput where the plant cannot rest there.
    """
    legs = (Leg(0.0, -10.0), Leg(1.0, 0.0)), (Leg(0.0, 0.0), Leg(2.0, 15.0))
    return manoeuvre("hop", equilibrium(bound, np.radians(-10.0)).x0, 8.0, sample_period_s, legs)


def manoeuvre(
    name: str, x0: Array, duration_s: float, sample_period_s: float, legs: Sequence[Sequence[Leg]]
) -> Manoeuvre:
    """References sampled from t = 0 to `duration_s`, one sequence of legs per output, from x0 (states,).

    Raises BadInput for a duration or sample period that is not finite and positive.
    """
    if not (np.isfinite(duration_s) and sample_period_s > 0.0 and duration_s >= sample_period_s):
        raise BadInput(
            "manoeuvre", name, f"{duration_s:g} s at {sample_period_s:g} s", "at least one sample", "give a longer time"
        )
    t_s = np.asarray(np.arange(round(duration_s / sample_period_s) + 1) * sample_period_s, dtype=float)
    return Manoeuvre(name, t_s, np.column_stack([profile_rad(axis, t_s) for axis in legs]), x0)


def on_encoder_steps(legs: Sequence[Leg], step_rad: float) -> tuple[Leg, ...]:
    """The same legs ending on whole encoder steps: asked for an angle between two, an integrating loop hunts from one to the other."""
    step_deg = math.degrees(step_rad)
    return tuple(replace(leg, angle_deg=step_deg * round(leg.angle_deg / step_deg)) for leg in legs)


def profile_rad(legs: Sequence[Leg], t_s: Array) -> Array:
    """Reference of one axis at t_s (n,) in rad; the first leg holds from the start."""
    angle_deg = np.full(t_s.shape, legs[0].angle_deg)
    for leg in legs[1:]:
        later = t_s >= leg.at_s - 1e-9
        start_deg = angle_deg[np.argmax(later)]
        way_deg = leg.angle_deg - start_deg
        done = (
            np.ones(t_s.shape)
            if np.isinf(leg.rate_deg_s)
            else (t_s - leg.at_s) * leg.rate_deg_s / max(abs(way_deg), 1e-12)
        )
        angle_deg = np.where(later, start_deg + way_deg * np.clip(done, 0.0, 1.0), angle_deg)
    return np.asarray(np.radians(angle_deg), dtype=float)


def at_rest(bound: BoundPlant) -> Array:
    """State (states,) with everything still, the first axis on its lower stop and all else at 0."""
    model = bound.model
    x0 = np.zeros(len(model.states))
    first = model.axes[0]
    if first.lower is not None and first.position is not None:
        x0[model.states.index(first.position)] = bound.number(first.lower)
    return x0
