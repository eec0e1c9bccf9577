"""Free curves that a missing term may follow, whatever its cause: any function of one signal at each place.

(1)  f(x) = b_0 + b_1 sgn(x) + b_2 x + sum of b_k max(0, x - x_k)

with knots x_k evenly over all that the logs show of x, and a sign, rounded at rest, only of what is a speed or an input. Where its weights
are normal and of one variance, f is a random curve whose second differences are white: a smoothing spline (Eilers and Marx 1996). None is a
function of time: what comes and goes is rather noise.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.forms import REST
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.signals import (
    Quantity,
    Signals,
    angle_names,
    input_name,
    motionless,
    rotor_name,
    signals,
    through,
)
from diagnosis.hypothesis.case import Case
from records.text.units import stem
from sim.edits import speed_name

Array = NDArray[np.float64]
# A bumper's edge then lies within a thirtieth of the way of one. Of three rigs 8 explain two as well, a stiff bumper a tenth worse.
KNOTS = 16
ALONE, PER_SECOND = Quantity("", ""), Quantity("time", "s")


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve f of what it `depends` on, times a factor (ALONE: none): its place, its class ("torque(phi) on azimuth"), its target (see
    filter.py), its `basis` (1), which takes x (k,) to (k, weights), and by flight instants t_s (instants,), x (instants,) and what each
    weight adds to the target (instants, weights), to a state in a second. x and the factor are in units of their sizes."""

    place: str
    class_text: str
    target: int
    depends: Quantity
    times: Quantity
    basis: Callable[[Array], Array]
    t_s: tuple[Array, ...]
    x: tuple[Array, ...]
    values: tuple[Array, ...]

    def along(self, linearisation: Linearisation) -> "Curve":
        """The same of other logs of the plant: of what these show, by the basis of its own."""
        asked = self.place, self.class_text
        each = [
            next(term for term in terms if (term.place, term.class_text) == asked)
            for terms in _by_flight(linearisation)
        ]
        return _of_logs(each, self.basis, _instants(linearisation))

    @property
    def weights(self) -> int:
        """How many it has."""
        return int(self.values[0].shape[1])

    def at(self, flight: int, t_s: Array) -> Array:
        """Its values at other instants of a flight (steps, weights)."""
        own, values = self.t_s[flight], self.values[flight]
        return values if np.array_equal(own, t_s) else np.stack([np.interp(t_s, own, one) for one in values.T], axis=1)


@dataclass(frozen=True, eq=False)
class _Term:
    """A flight's part of a curve: f of `x` (steps,) times `factor` (steps,), each with its quantity; `turns`: f may jump where x changes
    its sign; `gathers`: the target has the sum of all that f was in seconds before."""

    place: str
    class_text: str
    target: int
    depends: Quantity
    x: Array
    factor: Array
    times: Quantity = ALONE
    turns: bool = False
    gathers: bool = False


def curves(linearisation: Linearisation) -> list[Curve]:
    """All curves for the case's plant, in a fixed order; none of a signal that stands."""
    found = []
    for terms in zip(*_by_flight(linearisation), strict=True):
        basis = _basis(np.concatenate([term.x for term in terms]), terms[0].turns)
        found += [] if basis is None else [_of_logs(terms, basis, _instants(linearisation))]
    return found


def _by_flight(linearisation: Linearisation) -> list[list[_Term]]:
    """The terms of all curves by flight, in a fixed order."""
    case = linearisation.case
    return [list(_terms(case, signals(linearisation, flight, {}))) for flight in range(len(case.flights))]


def _instants(linearisation: Linearisation) -> tuple[Array, ...]:
    return tuple(filter_input.t_s for filter_input in linearisation.filter_inputs)


def _of_logs(terms: Sequence[_Term], basis: Callable[[Array], Array], t_s: tuple[Array, ...]) -> Curve:
    """One curve of each flight's term."""
    first, x = terms[0], tuple(term.x for term in terms)
    values = tuple(basis(term.x) * term.factor[:, None] for term in terms)
    if first.gathers:
        values = tuple(_gathered(value, own) for value, own in zip(values, t_s, strict=True))
    return Curve(first.place, first.class_text, first.target, first.depends, first.times, basis, t_s, x, values)


def _gathered(values: Array, t_s: Array) -> Array:
    """The integral of values (instants, weights) since the first instant."""
    over_steps = 0.5 * (values[1:] + values[:-1]) * np.diff(t_s)[:, None]
    return np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(over_steps, axis=0)])


def _basis(seen: Array, turns: bool) -> Callable[[Array], Array] | None:
    """(1) without its weights, of a signal of which the logs show `seen`; None where it stands."""
    low, high = float(seen.min()), float(seen.max())
    span = high - low
    if not span > 1e-9 * max(1.0, abs(low), abs(high)):
        return None
    knots = np.linspace(low, high, KNOTS + 2)[1:-1]

    def basis(x: Array) -> Array:
        whole = [np.ones_like(x), (x - low) / span - 0.5, *([np.tanh(x / REST)] if turns and low < 0.0 < high else [])]
        return np.stack([*whole, *(np.maximum(x - knot, 0.0) / span for knot in knots)], axis=1)

    return basis


def _terms(case: Case, s: Signals) -> Iterator[_Term]:
    for axis in case.library.bound.model.axes:
        yield from _on_axis(case, axis.name, str(axis.velocity), s)
    for rotor in s.rotor:
        yield from _on_drive(case, rotor, s)
        yield from _on_thrust(case, rotor, s)
    yield from _on_inputs(case, s)
    yield from _on_states(case, s)
    yield from _on_sensors(case, s)


def _on_axis(case: Case, axis: str, velocity: str, s: Signals) -> Iterator[_Term]:
    """Torques by any signal alone, and by one times the axis' own speed or its sign; an inertia that another angle changes. What a rotor's
    speed does alone to the axis that it pushes is its thrust."""
    has_angle, q, w, v = axis in s.angle, _angle(case, axis), _speed(case, axis), s.speed[axis]
    alone, sign = np.ones_like(v), np.tanh(v / REST)
    by_speed = {w.name: (w, v), f"sgn {w.name}": (Quantity(f"sgn({w.name})", ""), sign)}
    target, inertia = case.library.states.index(velocity), s.inertia[axis]

    def torque(text: str, depends: Quantity, x: Array, turns: bool = False) -> _Term:
        return _Term(axis, f"torque({text}) on {axis}", target, depends, x, alone / inertia, turns=turns)

    def by(text: str, depends: Quantity, x: Array) -> _Term:
        times, factor = by_speed[text]
        return _Term(axis, f"torque({depends.name}, {text}) on {axis}", target, depends, x, factor / inertia, times)

    if has_angle:
        yield torque(q.name, q, s.angle[axis])
    yield torque(w.name, w, v, True)
    for rotor, speed in s.rotor.items():
        o = _rotor(case, rotor)
        if axis not in case.library.bound.model.places.rotors[rotor].thrusts:
            yield torque(o.name, o, speed, True)
        yield torque(f"d{o.name}/dt", _rate(o), np.gradient(speed, s.t))
        yield from (by(text, o, np.abs(speed)) for text in by_speed)
    if has_angle:
        yield from (by(text, q, s.angle[axis]) for text in by_speed)
    for other in (name for name in s.angle if name != axis):
        p, p_dot = _angle(case, other), _speed(case, other)
        yield torque(p.name, p, s.angle[other])
        yield torque(p_dot.name, p_dot, s.speed[other], True)
        yield by(w.name, p, s.angle[other])
        yield _Term(axis, f"inertia({p.name}) of {axis}", target, p, s.angle[other], np.gradient(v, s.t), _rate(w))


def _on_drive(case: Case, rotor: str, s: Signals) -> Iterator[_Term]:
    """What an input does by itself, by its change, by another input, by how far its rotor lags it; a rotor's own torque."""
    places = case.library.bound.model.places
    entry, place = places.rotors[rotor], _place_of(case, rotor)
    u, own, o = s.u[place], _input(case, place), _rotor(case, rotor)
    for target, inertia in through(case, rotor, s):
        by_input = _Term(place, own.name, target, own, u, 1.0 / inertia, turns=True)
        yield by_input
        yield replace(by_input, class_text=f"change of {own.name}", x=np.append(0.0, np.diff(u)))
        if entry.drive is not None:
            yield replace(by_input, class_text=f"limit({own.name}, {o.name})", x=u - s.rotor[rotor])
            yield replace(by_input, place=rotor, class_text=f"torque({o.name}) on rotor", depends=o, x=s.rotor[rotor])
        yield from _by_others(case, place, target, u / inertia, s)


def _by_others(case: Case, place: str, target: int, factor: Array, s: Signals) -> Iterator[_Term]:
    """What of an input another may take away; `factor` is what the input does to the target."""
    own = _input(case, place)
    for other in (name for name in s.u if name != place):
        beside = _input(case, other)
        yield _Term(place, f"{own.name}, {beside.name}", target, beside, np.abs(s.u[other]), factor, own)


def _on_inputs(case: Case, s: Signals) -> Iterator[_Term]:
    """What an input that no rotor takes does by itself, by its change, and by another."""
    for place, (state, slope) in s.reach.items():
        own, target = _input(case, place), case.library.states.index(state)
        by_input = _Term(place, own.name, target, own, s.u[place], slope, turns=True)
        yield by_input
        yield replace(by_input, class_text=f"change of {own.name}", x=np.append(0.0, np.diff(s.u[place])))
        yield from _by_others(case, place, target, s.u[place] * slope, s)


def _on_states(case: Case, s: Signals) -> Iterator[_Term]:
    """What the rate of a measured state that does not move does by itself, and by an input times it."""
    for state, x in s.state.items():
        own, target = _state(case, state), case.library.states.index(state)
        yield _Term(own.name, f"rate({own.name}) of {own.name}", target, own, x, np.ones_like(x), turns=True)
        for place, u in s.u.items():
            beside = _input(case, place)
            yield _Term(own.name, f"rate({beside.name}, {own.name}) of {own.name}", target, beside, u, x, own)


def _on_thrust(case: Case, rotor: str, s: Signals) -> Iterator[_Term]:
    """Thrust by the rotor's own speed, by the angle and the speed of the axis that it pushes, by another rotor's speed."""
    model, o = case.library.bound.model, _rotor(case, rotor)
    own = Quantity(f"thrust of the {rotor}".replace("_", " "), "rad/s^2")
    for axis in (entry for entry in model.axes if entry.name in model.places.rotors[rotor].thrusts):
        target, thrust = case.library.states.index(str(axis.velocity)), s.thrust[rotor, axis.name]
        yield _Term(rotor, f"thrust({o.name})", target, o, s.rotor[rotor], thrust, own, True)
        if axis.name in s.angle:
            q, w, against = _angle(case, axis.name), _speed(case, axis.name), np.abs(s.rotor[rotor])
            yield _Term(rotor, f"thrust({q.name})", target, q, s.angle[axis.name], thrust, own)
            turning = replace(o, name=f"|{o.name}|")
            text = f"thrust({o.name}, {w.name})"
            yield _Term(rotor, text, target, w, s.speed[axis.name], against / s.inertia[axis.name], turning, True)
        for other in (name for name in s.rotor if name != rotor):
            p = _rotor(case, other)
            yield _Term(rotor, f"thrust({p.name})", target, p, np.abs(s.rotor[other]), thrust, own)


def _on_sensors(case: Case, s: Signals) -> Iterator[_Term]:
    """Errors of a reading by any angle, by the own speed and by a rotor's speed; and errors that grow with the way at some
    speeds, as an encoder's that loses counts. An input is no rotor's speed here: what a controller commands in a row it made of the row's
    own reading, errors and all."""
    library, places = case.library, case.library.bound.model.places
    for place, sensor in places.sensors.items():
        axis = next((name for name, entry in places.axes.items() if entry.angle == sensor.output), "")
        if axis not in s.angle:
            continue
        target = len(library.states) + library.outputs.index(sensor.output)
        w, v, q = _speed(case, axis), s.speed[axis], _angle(case, axis).name
        alone = np.ones_like(v)
        yield _Term(place, f"output(sum of {w.name}) of {q}", target, w, v, alone, PER_SECOND, True, True)
        known = [(_angle(case, other), s.angle[other], False) for other in s.angle]
        known.append((w, v, True))
        known += [
            (_rotor(case, name), s.rotor[name], True)
            for name, rotor in places.rotors.items()
            if rotor.drive is not None
        ]
        for depends, x, turns in known:
            yield _Term(place, f"output({depends.name}) of {q}", target, depends, x, alone, turns=turns)


def _angle(case: Case, axis: str) -> Quantity:
    return Quantity(angle_names(case)[axis], case.library.bound.model.places.axes[axis].length_unit)


def _speed(case: Case, axis: str) -> Quantity:
    model = case.library.bound.model
    return Quantity(speed_name(model, axis), f"{_angle(case, axis).unit}/s", model.places.axes[axis].speed_size)


def _rate(of: Quantity) -> Quantity:
    unit = f"{of.unit}^2" if of.unit.endswith("/s") else f"{of.unit}/s"
    return Quantity(f"d{of.name}/dt", unit, of.size)


def _rotor(case: Case, rotor: str) -> Quantity:
    place = case.library.bound.model.places.rotors[rotor]
    unit = "rad/s" if place.drive is not None else _input(case, _place_of(case, rotor)).unit
    return Quantity(rotor_name(case, rotor), unit, place.speed_size)


def _state(case: Case, state: str) -> Quantity:
    place = motionless(case.library.bound.model)[state]
    return Quantity(stem(state), place.unit, place.size)


def _place_of(case: Case, rotor: str) -> str:
    """The place of the input that drives a rotor."""
    places = case.library.bound.model.places
    return next(key for key, entry in places.inputs.items() if entry.variable == places.rotors[rotor].variable)


def _input(case: Case, place: str) -> Quantity:
    entry = case.library.bound.model.places.inputs[place]
    return Quantity(input_name(case, place), entry.unit, entry.size)
