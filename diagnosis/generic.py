"""Forms that a missing term could have, whatever its cause: by place, by what it depends on. They are answered linearly, not fitted."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis.case import Case
from diagnosis.ground import Ground
from diagnosis.waves import likely_waves
from sim.model import TIME

Array = NDArray[np.float64]
REST = 0.02  # of a speed's typical size: below it the sign of the speed fades


@dataclass(frozen=True, eq=False)
class Form:
    """One form: where it acts, its class ("torque(phi) on azimuth"), its target (see filter.py) and its values by flight (steps,)."""

    place: str
    class_text: str
    target: int
    values: tuple[Array, ...]


@dataclass(frozen=True, eq=False)
class Signals:
    """What a flight went through, by instant: angles and speeds by axis, rotor speeds, inputs, relative inertia by axis, time, waves."""

    t: Array
    h: Array
    angle: Mapping[str, Array]
    speed: Mapping[str, Array]
    rotor: Mapping[str, Array]
    thrust: Mapping[tuple[str, str], Array]
    inertia: Mapping[str, Array]
    u: Mapping[str, Array]
    waves: Mapping[str, tuple[float, ...]]


def signals(ground: Ground, flight: int, waves: Mapping[str, tuple[float, ...]]) -> Signals:
    """The signals that the filter predicts for a flight."""
    kit = ground.case.kit
    model, tape, run = kit.bound.model, ground.tapes[flight], ground.runs[flight]
    x = np.nan_to_num(_by_step(run.x[:, : len(model.states)], tape.row))
    p = kit.bound.p
    arguments = (TIME, *model.states, *model.inputs, *model.parameter_symbols)
    given = (tape.t_s, *x.T, *tape.u.T, *p)

    def value(expression: sympy.Expr) -> Array:
        found = sympy.lambdify(arguments, expression, "numpy", cse=True)(*given)
        return np.broadcast_to(np.asarray(found, float), tape.t_s.shape)

    axes = {axis.name: axis for axis in model.axes if axis.position is not None}
    return Signals(
        t=tape.t_s,
        h=np.append(np.diff(tape.t_s), 0.0),
        angle={name: value(axis.position) for name, axis in axes.items()},
        speed={name: value(axis.velocity) / model.places.axes[name].speed_size for name, axis in axes.items()},
        rotor={name: value(rotor.speed) / rotor.speed_size for name, rotor in model.places.rotors.items()},
        thrust={
            (name, axis): value(torque / axes[axis].inertia)
            for name, rotor in model.places.rotors.items()
            for axis, torque in rotor.thrusts.items()
        },
        inertia={name: _relative(value(axis.inertia)) for name, axis in axes.items()},
        u={name: value(entry.variable) / entry.size for name, entry in model.places.inputs.items()},
        waves=waves,
    )


def _relative(inertia: Array) -> Array:
    return inertia / np.mean(inertia)


def _by_step(x: Array, row: NDArray[np.int64]) -> Array:
    """Rows of a log held over a tape's instants."""
    known = np.maximum.accumulate(np.where(row >= 0, row, 0))
    return np.asarray(x[known])


def forms(ground: Ground) -> list[Form]:
    """All forms for the case's plant, in a fixed order."""
    case = ground.case
    states = case.kit.states
    waves = {
        axis.name: likely_waves(ground, states.index(str(axis.velocity)))
        for axis in case.kit.bound.model.axes
        if axis.position is not None
    }
    each = [list(_forms(case, signals(ground, flight, waves))) for flight in range(len(case.flights))]
    return [
        Form(place, text, target, tuple(flight[index][3] for flight in each))
        for index, (place, text, target, _) in enumerate(each[0])
    ]


Row = tuple[str, str, int, Array]


def _forms(case: Case, s: Signals) -> Iterator[Row]:
    yield from _axis_forms(case, s)
    yield from _drive_forms(case, s)
    yield from _sensor_forms(case, s)


def _axis_forms(case: Case, s: Signals) -> Iterator[Row]:
    kit, model = case.kit, case.kit.bound.model
    for axis in model.axes:
        if axis.name not in s.angle:
            continue
        target = kit.states.index(str(axis.velocity))
        scale = s.h / s.inertia[axis.name]
        for depends, value in _torques(case, axis.name, s):
            yield axis.name, f"torque({depends}) on {axis.name}", target, value * scale
        for depends, value in _inertias(case, axis.name, s):
            yield axis.name, f"inertia({depends}) of {axis.name}", target, value * s.h


def _torques(case: Case, axis: str, s: Signals) -> Iterator[tuple[str, Array]]:
    """What a torque may depend on, with up to four shapes for each."""
    names = angle_names(case)
    a, v = s.angle[axis], s.speed[axis]
    q, w, sign = names[axis], f"{names[axis]}_dot", np.tanh(v / REST)
    yield from _shapes(q, a, (np.sin, lambda x: x, np.square, lambda x: np.sin(2 * x), lambda x: x**3))
    yield from _shapes(q, a, tuple(_wave(k, shift) for k in range(3, 17) for shift in (0.0, np.pi / 2)))
    yield from _shapes(w, v, (lambda x: x * np.abs(x), lambda x: x**3))
    yield from _shapes(f"sgn {w}", v, (lambda x: sign, lambda x: sign * np.exp(-np.abs(x) / 0.1), np.abs))
    yield f"{q}, sgn {w}", a * sign
    yield f"{q}, sgn {w}", _follower(a, 0.2)
    yield from ((f"{q}, {w}", shape * v) for shape in (a, a**2, np.sin(a), np.cos(a)))
    time = s.t / s.t[-1]
    yield from (("t", shape) for shape in (time, time**2))
    for rate in s.waves.get(axis, ()):
        yield from (("t", wave(rate * s.t)) for wave in (np.sin, np.cos))
    yield f"t, {w}", time * v
    for rotor, speed in s.rotor.items():
        o = rotor_name(case, rotor)
        yield from _shapes(o, speed, (lambda x: x * np.abs(x), lambda x: x))
        yield f"{o}, {w}", np.abs(speed) * v
        yield f"{o}, sgn {w}", np.abs(speed) * sign
        yield f"d{o}/dt", np.gradient(speed, s.t)
    for other in s.angle:
        if other != axis:
            yield from _between(names[other], s.angle[other], s.speed[other], w, v)


def _between(q: str, angle: Array, speed: Array, own: str, v: Array) -> Iterator[tuple[str, Array]]:
    yield from _shapes(q, angle, (lambda x: x, np.square))
    yield f"{q}_dot", speed
    yield f"{q}, {q}_dot, {own}", np.sin(2.0 * angle) * speed * v
    yield f"{q}, {own}", v * angle


def _inertias(case: Case, axis: str, s: Signals) -> Iterator[tuple[str, Array]]:
    """An inertia that another angle changes: its share of the acceleration."""
    names = angle_names(case)
    acceleration = np.gradient(s.speed[axis], s.t)
    for other in s.angle:
        if other != axis:
            yield names[other], acceleration * np.cos(s.angle[other])
            yield names[other], acceleration * np.sin(s.angle[other]) ** 2


def _drive_forms(case: Case, s: Signals) -> Iterator[Row]:
    places = case.kit.bound.model.places
    for name, rotor in places.rotors.items():
        place = next((key for key, entry in places.inputs.items() if entry.variable == rotor.variable), "")
        u, time = s.u[place], s.t / s.t[-1]
        text = str(rotor.variable).rsplit("_", 1)[0]
        through = list(_through(case, name, s))
        for target, gain in through:
            for shape in (np.tanh(u / 0.03), np.abs(u), u * np.abs(u), np.append(0.0, np.diff(u)), _jitter(u)):
                yield place, f"{text}", target, shape * gain
            pull = u - s.rotor[name]
            yield from ((place, f"limit({text})", target, shape * gain) for shape in _beyond(u))
            if rotor.drive is not None:
                limit = f"limit({text}, {rotor_name(case, name)})"
                yield from ((place, limit, target, shape * gain) for shape in _beyond(pull))
            for other, value in s.u.items():
                if other != place:
                    yield place, f"{text}, {other}", target, u * np.abs(value) * gain
            yield name, f"gain(t) of {text}", target, u * time * gain
        speed, o = s.rotor[name], rotor_name(case, name)
        for target, gain in through[: 1 if rotor.drive is not None else 0]:
            for shape in (np.tanh(speed / 0.02), speed * np.abs(speed), speed**3):
                yield name, f"torque({o}) on rotor", target, shape * gain
        for axis in rotor.thrusts:
            yield from _thrust_forms(case, name, axis, s)


def _thrust_forms(case: Case, rotor: str, axis: str, s: Signals) -> Iterator[Row]:
    kit = case.kit
    velocity = next(str(entry.velocity) for entry in kit.bound.model.axes if entry.name == axis)
    target, thrust = kit.states.index(velocity), s.thrust[rotor, axis] * s.h
    names, o = angle_names(case), rotor_name(case, rotor)
    speed = s.rotor[rotor]
    for shape in (np.abs(speed), speed**2, np.tanh(speed / 0.02), speed**4):
        yield rotor, f"thrust({o})", target, shape * thrust
    for name, angle in s.angle.items():
        if name == axis:
            yield rotor, f"thrust({names[name]})", target, np.exp(-(angle - angle.min()) / 0.3) * thrust
        if name == axis:
            yield rotor, f"thrust({o}, {names[name]}_dot)", target, np.abs(speed) * s.speed[name] * s.h
    for other, value in s.rotor.items():
        if other != rotor:
            yield rotor, f"thrust({rotor_name(case, other)})", target, np.abs(value) * thrust


def _sensor_forms(case: Case, s: Signals) -> Iterator[Row]:
    kit, model = case.kit, case.kit.bound.model
    names = angle_names(case)
    for place, sensor in model.places.sensors.items():
        axis = next((name for name, entry in model.places.axes.items() if entry.angle == sensor.output), "")
        if axis not in s.angle:
            continue
        a, v, q = s.angle[axis], s.speed[axis], names[axis]
        target = len(kit.states) + kit.outputs.index(sensor.output)
        for shape in (a, np.square(a), *(_wave(k, shift)(a) for k in range(3, 33) for shift in (0.0, np.pi / 2))):
            yield place, f"output({q}) of {q}", target, shape
        yield place, f"output({q}_dot) of {q}", target, v
        yield place, f"output(sgn {q}_dot) of {q}", target, np.tanh(v / REST)
        for other in s.angle:
            if other != axis:
                yield place, f"output({names[other]}) of {q}", target, s.angle[other]


def _through(case: Case, rotor: str, s: Signals) -> Iterator[tuple[int, Array]]:
    """Where an input's change enters: the rotor's speed, or the axes that it pushes where the speed is no state."""
    kit, place = case.kit, case.kit.bound.model.places.rotors[rotor]
    if place.drive is not None:
        yield kit.states.index(str(place.speed)), s.h
        return
    axis = next(iter(place.thrusts))
    velocity = next(str(entry.velocity) for entry in kit.bound.model.axes if entry.name == axis)
    yield kit.states.index(velocity), s.h / s.inertia[axis]


def _shapes(depends: str, x: Array, shapes: Sequence[Callable[[Array], Array]]) -> Iterator[tuple[str, Array]]:
    return ((depends, np.asarray(shape(x), float)) for shape in shapes)


def _wave(count: int, shift: float) -> Callable[[Array], Array]:
    return lambda x: np.asarray(np.sin(count * x + shift))


def _beyond(x: Array) -> Iterator[Array]:
    """What of x lies beyond its rare values on either side."""
    for share in (2.0, 5.0, 15.0, 85.0, 95.0, 98.0):
        edge = float(np.percentile(x, share))
        yield np.maximum(x - edge, 0.0) if share > 50.0 else np.minimum(x - edge, 0.0)


def _follower(x: Array, width: float) -> Array:
    """Where a brush of stiff bristles of `width` stands that x drags along."""
    z, found = 0.0, []
    for change in np.diff(x, prepend=x[0]).tolist():
        z = min(max(z + change, -width), width)
        found.append(z)
    return np.array(found)


def _jitter(u: Array) -> Array:
    return np.append(0.0, np.abs(np.diff(u)))


def angle_names(case: Case) -> dict[str, str]:
    """Axis -> its angle's short name (psi)."""
    return {name: entry.angle.rsplit("_", 1)[0] for name, entry in case.kit.bound.model.places.axes.items()}


def rotor_name(case: Case, rotor: str) -> str:
    """The short name of a rotor's speed (omega_M), or of its input where it has no speed of its own."""
    place = case.kit.bound.model.places.rotors[rotor]
    if place.drive is None:
        return str(place.variable).rsplit("_", 1)[0]
    return f"omega_{place.letter}" if place.letter else "omega"
