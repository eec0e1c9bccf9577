"""What the references do over a flight: holds, steps and ramps."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.table import Table
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint, equilibrium, rest_under, rest_with
from sim.kernel.reference import reference
from sim.wiring import wiring

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


# A flight of a plant that is no helicopter: each loop in turn goes to these shares of its references' range about the middle, and is
# left alone for so many of its slowest time constants, its reference filter's counted as two.
STEP_SHARES = (0.0, 0.5, -0.3, 0.0)
LEAST_HOP = (
    min(abs(after - before) for before, after in pairwise(STEP_SHARES)) / 2.0
)  # of a range, in one of these steps
TIME_CONSTANTS = 8.0
SHORTEST_HOLD_S, LONGEST_HOLD_S = 4.0, 15.0
LONGEST_HOLD_SAMPLES = (
    25_000  # of a slow plant, of few samples a second: an oven of 50 s behind a filter of 40 s takes 1040 s
)


def steps(bound: BoundPlant, table: Table[Any]) -> Manoeuvre:
    """Steps of each loop of a table in turn, from rest in the middle of its references; outputs without a loop stay where they rest.

    Raises BadInput where the plant cannot rest there, or does not have the loops' columns.
    """
    wires = wiring(bound, table.loops)
    middle_rad = [0.5 * (axis.reference_min_rad + axis.reference_max_rad) for axis in table.axes]
    point = rest_with(bound, wires.outputs, middle_rad, wires.inputs)
    legs: list[tuple[Leg, ...]] = [(Leg(0.0, math.degrees(y)),) for y in resting_outputs(bound, point)]
    at_s = 0.0
    for place, axis, centre_rad, loop in zip(wires.outputs, table.axes, middle_rad, table.loops, strict=True):
        half_rad, held_s = 0.5 * (axis.reference_max_rad - axis.reference_min_rad), hold_s(table, axis, loop.axis)
        moved = [
            Leg(at_s + index * held_s, math.degrees(centre_rad + share * half_rad))
            for index, share in enumerate(STEP_SHARES)
        ]
        legs[place] = (replace(moved[0], at_s=0.0), *moved[1:])
        at_s += len(STEP_SHARES) * held_s
    each = zip(legs, bound.encoder_steps, strict=True)
    return manoeuvre("steps", point.x0, at_s, table.sample_period_s, [on_encoder_steps(*pair) for pair in each])


def hold_s(table: Table[Any], axis: Any, name: str) -> float:
    """How long a step of one loop is left alone [s]; a table that states no poles is as slow as 1 rad/s."""
    poles = table.origin.get(name, {}).get("poles_rad_s", [[-1.0, 0.0]])
    slowest_s = 1.0 / max(min(abs(real) for real, _ in poles), 1e-3)
    wanted_s = float(TIME_CONSTANTS * (slowest_s + 2.0 * axis.prefilter_time_constant_s))
    longest_s = max(LONGEST_HOLD_S, LONGEST_HOLD_SAMPLES * table.sample_period_s)
    return min(max(wanted_s, SHORTEST_HOLD_S), longest_s)


def resting_outputs(bound: BoundPlant, point: OperatingPoint) -> list[float]:
    """What the outputs read at rest (outputs,), each in its own unit."""
    no_friction = np.zeros(len(bound.model.axes))
    read: list[float] = reference(bound.model).outputs(0.0, point.x0, point.u0, bound.p, no_friction).tolist()
    return read


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


# What stirs a plant without a loop: each input changes at once between levels about its rest, as shares of what it may command, so that
# slow and fast parts answer. It is long enough for a rig's slowest axis to settle once, and each input begins later than the one before.
# All times are in the plant's own seconds (Model.second_s).
STIR_S = 20.0
STIR_AT_S = (1.0, 3.0, 5.0, 6.0, 7.0, 8.5, 9.5, 10.0, 10.5, 11.25, 12.0, 12.5, 13.0, 13.25, 13.5, 14.0, 15.0, 17.0)
STIR_LEVEL = (0.2, -0.2, 0.1, -0.1, 0.2, 0.0, -0.2, 0.2, -0.1, 0.2, -0.2, 0.1, -0.2, 0.2, 0.0, -0.1, 0.1, 0.0)
STIR_LATER_S = 0.4
DISPLACED = 0.3  # of an output's usual range: where a plant without inputs begins


@dataclass(frozen=True, eq=False)
class Stir:
    """A run without a loop: sample times t_s (n,), inputs u (n, inputs), and the plant's state x0 (states,) at t_s[0]."""

    t_s: Array
    u: Array
    x0: Array


def stir(bound: BoundPlant, sample_period_s: float = 0.01) -> Stir:
    """Steps of every input about where the plant rests, or, where nothing drives it, a start away from there."""
    own_s = np.asarray(np.arange(round(STIR_S / sample_period_s) + 1) * sample_period_s, dtype=float)
    x0, u0 = _rest(bound)
    u = np.tile(u0, (own_s.size, 1))
    for column, variable in enumerate(bound.model.inputs):
        low, high = bound.commands(variable)
        after = np.searchsorted(np.array(STIR_AT_S) + column * STIR_LATER_S, own_s, side="right")
        level = np.concatenate([[0.0], STIR_LEVEL])[after]
        u[:, column] = np.clip(u0[column] + level * (high - low) / 2.0, low, high)
    return Stir(bound.model.second_s * own_s, u, x0 if bound.model.inputs else x0 + _displaced(bound))


def _rest(bound: BoundPlant) -> tuple[Array, Array]:
    """State and inputs where the plant rests in the middle of its stops, or without a position under the middle of its inputs' ranges: a
    tank half open, an oven half on. Where it rests nowhere, all at 0 and the inputs' least effort."""
    model = bound.model
    arms = [axis for axis in model.axes if axis.position is not None]
    if not arms:
        with suppress(BadInput):
            point = rest_under(bound, np.array([sum(bound.commands(variable)) / 2.0 for variable in model.inputs]))
            return point.x0, point.u0
    middle = [
        0.0 if a.lower is None or a.upper is None else (bound.number(a.lower) + bound.number(a.upper)) / 2.0
        for a in arms
    ]
    try:
        point = equilibrium(bound, *middle)
        return point.x0, point.u0
    except BadInput:
        x0 = np.zeros(len(model.states))
        for axis, position in zip(arms, middle, strict=True):
            x0[model.states.index(axis.position)] = position
        return x0, np.array([min(max(0.0, low), high) for low, high in map(bound.commands, model.inputs)])


def _displaced(bound: BoundPlant) -> Array:
    """How far each state that is an output or an axis' position lies off its rest, in its unit."""
    model = bound.model
    usual = {model.outputs[sensor.output]: sensor.size for sensor in model.places.sensors.values()}
    usual = {**{axis.position: 1.0 for axis in model.axes if axis.position is not None}, **usual}
    return np.array([DISPLACED * usual.get(state, 0.0) for state in model.states])
