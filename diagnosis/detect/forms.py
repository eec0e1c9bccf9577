"""Forms that a missing term could have, whatever its cause: by place, by what it depends on. They are answered linearly, not fitted."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.shapes import SQUARE, Shapes, beyond, follower, jitter, plain, shaped, waves_a_turn
from diagnosis.detect.signals import (
    Signals,
    angle_names,
    in_units,
    input_name,
    rotor_name,
    rotor_unit,
    signals,
    state_unit,
    through,
)
from diagnosis.detect.waves import likely_waves
from diagnosis.hypothesis.case import Case
from records.text.units import stem
from sim.edits import speed_name

Array = NDArray[np.float64]
REST = 0.02  # of a speed's typical size: below it the sign of the speed fades


@dataclass(frozen=True, eq=False)
class Form:
    """One form: where it acts, its class ("torque(phi) on azimuth"), its shape ("sin(phi)", see sparse.py), its target (see filter.py)
    and its values by flight (steps,)."""

    place: str
    class_text: str
    shape: str
    target: int
    values: tuple[Array, ...]


def forms(linearisation: Linearisation) -> list[Form]:
    """All forms for the case's plant, in a fixed order."""
    case = linearisation.case
    states = case.library.states
    waves = {
        axis.name: tuple(wave.number for wave in likely_waves(linearisation, states.index(str(axis.velocity))))
        for axis in case.library.bound.model.axes
        if axis.position is not None
    }
    each = [list(_forms(case, signals(linearisation, flight, waves))) for flight in range(len(case.flights))]
    return [
        Form(place, text, plain(shape), target, tuple(flight[index][-1] for flight in each))
        for index, (place, text, shape, target, _) in enumerate(each[0])
    ]


Row = tuple[str, str, str, int, Array]


def _forms(case: Case, s: Signals) -> Iterator[Row]:
    yield from _axis_forms(case, s)
    yield from _drive_forms(case, s)
    yield from _input_forms(case, s)
    yield from _state_forms(case, s)
    yield from _sensor_forms(case, s)


def _axis_forms(case: Case, s: Signals) -> Iterator[Row]:
    library, model = case.library, case.library.bound.model
    for axis in model.axes:
        target = library.states.index(str(axis.velocity))
        scale = s.h / s.inertia[axis.name]
        for depends, shape, value in _torques(case, axis.name, s):
            yield axis.name, f"torque({depends}) on {axis.name}", shape, target, value * scale
        for depends, shape, value in _inertias(case, axis.name, s):
            yield axis.name, f"inertia({depends}) of {axis.name}", shape, target, value * s.h


def _torques(case: Case, axis: str, s: Signals) -> Iterator[tuple[str, str, Array]]:
    """What a torque may depend on, with some shapes for each."""
    names = angle_names(case)
    v, w, unit = s.speed[axis], _speed_name(case, axis), _speed_unit(case, axis)
    sign = np.tanh(v / REST)
    if axis in s.angle:
        yield from _by_angle(names[axis], s.angle[axis])
    yield from shaped(w, unit, v, {SQUARE: lambda x: x * np.abs(x), "{x}^3": lambda x: x**3})
    rubs: Shapes = {"sgn({x})": lambda _: sign, "sgn({x}) exp(-|{x}| / 0.1)": lambda x: sign * np.exp(-np.abs(x) / 0.1)}
    yield from shaped(f"sgn {w}", unit, v, {**rubs, "|{x}|": np.abs})
    if axis in s.angle:
        yield from _by_angle_and_speed(names[axis], s.angle[axis], w, unit, v, sign)
    time = s.t / s.t[-1]
    yield from shaped("t", in_units("t", s.t[-1]), time, {"{x}": lambda x: x, "{x}^2": np.square})
    for rate in s.waves.get(axis, ()):
        for text, wave in (("sin", np.sin), ("cos", np.cos)):
            yield "t", f"{text}({rate:.3g} t)", wave(rate * s.t)
    yield f"t, {w}", f"{in_units('t', s.t[-1])} {unit}", time * v
    yield from _from_rotors(case, s, w, unit, v, sign)
    for other in s.angle:
        if other != axis:
            yield from _between((names[other], _speed_name(case, other)), s.angle[other], s.speed[other], unit, v)


def _by_angle(q: str, a: Array) -> Iterator[tuple[str, str, Array]]:
    """What of a torque may depend on the axis' own angle alone."""
    angles: Shapes = {"sin({x})": np.sin, "{x}": lambda x: x, "{x}^2": np.square}
    doubled = waves_a_turn((2,), ("sin({count} {x})",))
    yield from shaped(q, q, a, {**angles, **doubled, "{x}^3": lambda x: x**3, **waves_a_turn(range(3, 17))})


def _by_angle_and_speed(q: str, a: Array, w: str, unit: str, v: Array, sign: Array) -> Iterator[tuple[str, str, Array]]:
    """What of a torque may depend on the axis' own angle and speed."""
    yield f"{q}, sgn {w}", f"{q} sgn({unit})", a * sign
    yield f"{q}, sgn {w}", f"bristles of 0.2 under {q}", follower(a, 0.2)
    for text, shape in ((q, a), (f"{q}^2", a**2), (f"sin({q})", np.sin(a)), (f"cos({q})", np.cos(a))):
        yield f"{q}, {w}", f"{text} {unit}", shape * v


def _from_rotors(case: Case, s: Signals, w: str, unit: str, v: Array, sign: Array) -> Iterator[tuple[str, str, Array]]:
    """What of a torque may come from a rotor, alone or with the axis' own speed."""
    for rotor, speed in s.rotor.items():
        o = rotor_name(case, rotor)
        x = rotor_unit(case, rotor)
        yield from shaped(o, x, speed, {SQUARE: lambda x: x * np.abs(x), "{x}": lambda x: x})
        yield f"{o}, {w}", f"|{x}| {unit}", np.abs(speed) * v
        yield f"{o}, sgn {w}", f"|{x}| sgn({unit})", np.abs(speed) * sign
        yield f"d{o}/dt", f"d{x}/dt", np.gradient(speed, s.t)


def _between(
    names: tuple[str, str], angle: Array, speed: Array, own: str, v: Array
) -> Iterator[tuple[str, str, Array]]:
    """What of a torque may come from another axis, by the names of its angle and speed."""
    q, w = names
    yield from shaped(q, q, angle, {"{x}": lambda x: x, "{x}^2": np.square})
    yield w, w, speed
    yield f"{q}, {w}, {own}", f"sin(2 {q}) {w} {own}", np.sin(2.0 * angle) * speed * v
    yield f"{q}, {own}", f"{q} {own}", v * angle


def _inertias(case: Case, axis: str, s: Signals) -> Iterator[tuple[str, str, Array]]:
    """An inertia that another angle changes: its share of the acceleration."""
    names = angle_names(case)
    acceleration = np.gradient(s.speed[axis], s.t)
    for other in s.angle:
        if other != axis:
            q, own = names[other], f"d{_speed_unit(case, axis)}/dt"
            yield q, f"cos({q}) {own}", acceleration * np.cos(s.angle[other])
            yield q, f"sin({q})^2 {own}", acceleration * np.sin(s.angle[other]) ** 2


def _drive_forms(case: Case, s: Signals) -> Iterator[Row]:
    places = case.library.bound.model.places
    for name, rotor in places.rotors.items():
        place = next((key for key, entry in places.inputs.items() if entry.variable == rotor.variable), "")
        u, time = s.u[place], s.t / s.t[-1]
        text = input_name(case, place)
        x = in_units(text, places.inputs[place].size)
        speed, o, over = s.rotor[name], rotor_name(case, name), rotor_unit(case, name)
        ways = [(target, s.h / inertia) for target, inertia in through(case, name, s)]
        for target, gain in ways:
            yield from _by_input(case, place, target, gain, s)
            if rotor.drive is not None:
                for shape, value in beyond(f"{x} - {over}", u - speed):
                    yield place, f"limit({text}, {o})", shape, target, value * gain
            yield from _by_others(case, place, target, gain, s)
            yield name, f"gain(t) of {text}", f"{in_units('t', s.t[-1])} {x}", target, u * time * gain
        rubs: Shapes = {
            "sgn({x})": lambda x: np.tanh(x / 0.02),
            SQUARE: lambda x: x * np.abs(x),
            "{x}^3": lambda x: x**3,
        }
        for target, gain in ways[: 1 if rotor.drive is not None else 0]:
            for _, shape, value in shaped(o, over, speed, rubs):
                yield name, f"torque({o}) on rotor", shape, target, value * gain
        for axis in rotor.thrusts:
            yield from _thrust_forms(case, name, axis, s)


def _by_input(case: Case, place: str, target: int, gain: Array, s: Signals) -> Iterator[Row]:
    """What an input may do by itself, by its change, and beyond a limit."""
    u, text = s.u[place], input_name(case, place)
    x = in_units(text, case.library.bound.model.places.inputs[place].size)
    known: Shapes = {"sgn({x})": lambda x: np.tanh(x / 0.03), "|{x}|": np.abs, SQUARE: lambda x: x * np.abs(x)}
    for _, shape, value in shaped(text, x, u, known):
        yield place, text, shape, target, value * gain
    yield place, text, f"change of {x} from row to row", target, np.append(0.0, np.diff(u)) * gain
    yield place, text, f"size of the change of {x} from row to row", target, jitter(u) * gain
    for shape, value in beyond(x, u):
        yield place, f"limit({text})", shape, target, value * gain


def _by_others(case: Case, place: str, target: int, gain: Array, s: Signals) -> Iterator[Row]:
    """What of an input another may take away."""
    inputs, text = case.library.bound.model.places.inputs, input_name(case, place)
    x = in_units(text, inputs[place].size)
    for other, value in s.u.items():
        if other != place:
            size = f"|{in_units(input_name(case, other), inputs[other].size)}|"
            yield place, f"{text}, {other}", f"{x} {size}", target, s.u[place] * np.abs(value) * gain


def _input_forms(case: Case, s: Signals) -> Iterator[Row]:
    """What an input that no rotor takes may do by itself, with another and in time."""
    library = case.library
    for place, (state, slope) in s.reach.items():
        entry, text = library.bound.model.places.inputs[place], input_name(case, place)
        target, gain, time = library.states.index(state), s.h * slope, s.t / s.t[-1]
        yield from _by_input(case, place, target, gain, s)
        yield from _by_others(case, place, target, gain, s)
        shape = f"{in_units('t', s.t[-1])} {in_units(text, entry.size)}"
        yield place, f"gain(t) of {text}", shape, target, s.u[place] * time * gain


def _state_forms(case: Case, s: Signals) -> Iterator[Row]:
    """What the rate of a measured state that does not move may depend on: on itself, on time, on itself and an input."""
    library = case.library
    for state, x in s.state.items():
        name, unit, target, time = stem(state), state_unit(case, state), library.states.index(state), s.t / s.t[-1]
        own: Shapes = {"1": np.ones_like, SQUARE: lambda x: x * np.abs(x), "{x}^3": lambda x: x**3}
        for _, shape, value in shaped(name, unit, x, own):
            yield name, f"rate({name}) of {name}", shape, target, value * s.h
        for _, shape, value in shaped("t", in_units("t", s.t[-1]), time, {"{x}": lambda x: x, "{x}^2": np.square}):
            yield name, f"rate(t) of {name}", shape, target, value * s.h
        yield name, f"rate(t, {name}) of {name}", f"{in_units('t', s.t[-1])} {unit}", target, time * x * s.h
        for place, u in s.u.items():
            beside = input_name(case, place)
            size = in_units(beside, library.bound.model.places.inputs[place].size)
            yield name, f"rate({beside}, {name}) of {name}", f"{unit} {size}", target, x * u * s.h


def _thrust_forms(case: Case, rotor: str, axis: str, s: Signals) -> Iterator[Row]:
    library = case.library
    velocity = next(str(entry.velocity) for entry in library.bound.model.axes if entry.name == axis)
    target, thrust = library.states.index(velocity), s.thrust[rotor, axis] * s.h
    names, o, x = angle_names(case), rotor_name(case, rotor), rotor_unit(case, rotor)
    speed, own = s.rotor[rotor], f"thrust of the {rotor}".replace("_", " ")
    shapes: Shapes = {
        "|{x}|": np.abs,
        "{x}^2": np.square,
        "sgn({x})": lambda x: np.tanh(x / 0.02),
        "{x}^4": lambda x: x**4,
    }
    for _, shape, value in shaped(o, x, speed, shapes):
        yield rotor, f"thrust({o})", f"{shape} {own}", target, value * thrust
    for name, angle in s.angle.items():
        q = names[name]
        if name == axis:
            near = np.exp(-(angle - angle.min()) / 0.3)
            yield rotor, f"thrust({q})", f"exp(-{q} / 0.3) {own}", target, near * thrust
            w, unit = _speed_name(case, name), _speed_unit(case, name)
            yield rotor, f"thrust({o}, {w})", f"|{x}| {unit}", target, np.abs(speed) * s.speed[name] * s.h
    for other, value in s.rotor.items():
        if other != rotor:
            shape = f"|{rotor_unit(case, other)}| {own}"
            yield rotor, f"thrust({rotor_name(case, other)})", shape, target, np.abs(value) * thrust


def _sensor_forms(case: Case, s: Signals) -> Iterator[Row]:
    library, model = case.library, case.library.bound.model
    names = angle_names(case)
    for place, sensor in model.places.sensors.items():
        state, target = str(model.outputs[sensor.output]), len(library.states) + library.outputs.index(sensor.output)
        if state in s.state:
            name, unit = stem(state), state_unit(case, state)
            for _, shape, value in shaped(name, unit, s.state[state], {"{x}": lambda x: x, "{x}^2": np.square}):
                yield place, f"output({name}) of {name}", shape, target, value
        axis = next((name for name, entry in model.places.axes.items() if entry.angle == sensor.output), "")
        if axis not in s.angle:
            continue
        a, v, q = s.angle[axis], s.speed[axis], names[axis]
        w, unit = _speed_name(case, axis), _speed_unit(case, axis)
        for _, shape, value in shaped(q, q, a, {"{x}": lambda x: x, "{x}^2": np.square, **waves_a_turn(range(3, 33))}):
            yield place, f"output({q}) of {q}", shape, target, value
        yield place, f"output({w}) of {q}", unit, target, v
        yield place, f"output(sgn {w}) of {q}", f"sgn({unit})", target, np.tanh(v / REST)
        for other in s.angle:
            if other != axis:
                yield place, f"output({names[other]}) of {q}", names[other], target, s.angle[other]


def _speed_name(case: Case, axis: str) -> str:
    return speed_name(case.library.bound.model, axis)


def _speed_unit(case: Case, axis: str) -> str:
    """An axis' speed in units of its size, as text."""
    return in_units(_speed_name(case, axis), case.library.bound.model.places.axes[axis].speed_size)
