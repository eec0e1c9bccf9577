"""What a flight went through as the filter predicts it, and the names under which forms speak of it."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis.detect.linearisation import Linearisation
from diagnosis.hypothesis.case import Case
from records.text.units import stem
from sim.model import TIME, Model
from sim.places import SensorPlace

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """What a signal is: its name, its unit, and the size in that unit by which it counts."""

    name: str
    unit: str
    size: float = 1.0


@dataclass(frozen=True, eq=False)
class Signals:
    """What a flight went through, by instant: angles by axis that has one, speeds by axis, rotor speeds, inputs, relative inertia by axis,
    what is measured and is no motion by state, time since the logs begin, waves. `reach` has, of an input that no rotor takes, the
    state that it reaches and what its size does to the rate of that."""

    t: Array
    h: Array
    angle: Mapping[str, Array]
    speed: Mapping[str, Array]
    rotor: Mapping[str, Array]
    thrust: Mapping[tuple[str, str], Array]
    inertia: Mapping[str, Array]
    u: Mapping[str, Array]
    state: Mapping[str, Array]
    reach: Mapping[str, tuple[str, Array]]
    waves: Mapping[str, tuple[float, ...]]


def signals(linearisation: Linearisation, flight: int, waves: Mapping[str, tuple[float, ...]]) -> Signals:
    """The signals that the filter predicts for a flight."""
    library = linearisation.case.library
    model, filter_input, run = library.bound.model, linearisation.filter_inputs[flight], linearisation.runs[flight]
    x = np.nan_to_num(by_step(run.x[:, : len(model.states)], filter_input.row))

    def value(expression: sympy.Expr) -> Array:
        return value_of(model, expression, filter_input.t_s, x, filter_input.u, library.bound.p)

    axes = {axis.name: axis for axis in model.axes}
    return Signals(
        t=filter_input.t_s - linearisation.case.begins_s,
        h=np.append(np.diff(filter_input.t_s), 0.0),
        angle={name: value(axis.position) for name, axis in axes.items() if axis.position is not None},
        speed={name: value(axis.velocity) / model.places.axes[name].speed_size for name, axis in axes.items()},
        rotor={name: value(rotor.speed) / rotor.speed_size for name, rotor in model.places.rotors.items()},
        thrust={
            (name, axis): value(torque / axes[axis].inertia)
            for name, rotor in model.places.rotors.items()
            for axis, torque in rotor.thrusts.items()
        },
        inertia={name: _relative(value(axis.inertia)) for name, axis in axes.items()},
        u={name: value(entry.variable) / entry.size for name, entry in model.places.inputs.items()},
        state={state: value(sympy.Symbol(state, real=True)) / place.size for state, place in motionless(model).items()},
        reach={
            name: (found[0], value(found[1]) * entry.size)
            for name, entry in model.places.inputs.items()
            if not model.places.driven_by(entry.variable) and (found := driven(model, entry.variable)) is not None
        },
        waves=waves,
    )


@lru_cache(maxsize=64)
def motionless(model: Model) -> dict[str, SensorPlace]:
    """The plant's own states that an output is, but for what moves, axes and rotors: currents, temperatures, levels; with the sensor."""
    moving = model.axis_states | {str(rotor.speed) for rotor in model.places.rotors.values()}
    read = {str(model.outputs[sensor.output]): sensor for sensor in model.places.sensors.values()}
    return {state: read[state] for state in map(str, model.states) if state in read and state not in moving}


@lru_cache(maxsize=64)
def driven(model: Model, variable: sympy.Symbol) -> tuple[str, sympy.Expr] | None:
    """The first state whose rate an input changes, an axis' velocity before others, and the slope of that rate by the input; None where it
    changes none."""
    rates = {str(axis.velocity): axis.torque / axis.inertia for axis in model.axes}
    rates |= {str(state): rate for state, rate in model.rates.items()}
    slopes = ((state, sympy.diff(rate, variable)) for state, rate in rates.items())
    return next(((state, slope) for state, slope in slopes if slope != 0), None)


def value_of(model: Model, expression: sympy.Expr, t_s: Array, x: Array, u: Array, p: Array) -> Array:
    """An expression's values (steps,) at times t_s with states x (steps, states) and inputs u (steps, inputs)."""
    found = _function(model, expression)(t_s, *x.T, *u.T, *p)
    return np.broadcast_to(np.asarray(found, float), t_s.shape)


@lru_cache(maxsize=256)
def _function(model: Model, expression: sympy.Expr) -> Callable[..., Array]:
    """An expression as a function of time, states, inputs and parameters: every score test of a flight asks for the same ones."""
    arguments = (TIME, *model.states, *model.inputs, *model.parameter_symbols)
    return sympy.lambdify(arguments, expression, "numpy", cse=True)  # type: ignore[no-any-return]


def _relative(inertia: Array) -> Array:
    return inertia / np.mean(inertia)


def by_step(x: Array, row: NDArray[np.int64]) -> Array:
    """Rows of a log held over a filter input's instants."""
    known = np.maximum.accumulate(np.where(row >= 0, row, 0))
    return np.asarray(x[known])


def in_units(name: str, size: float) -> str:
    """A signal in units of its size, as text."""
    return name if size == 1.0 else f"({name} / {size:.4g})"


def rotor_unit(case: Case, rotor: str) -> str:
    """A rotor's speed in units of its size, as text."""
    return in_units(rotor_name(case, rotor), case.library.bound.model.places.rotors[rotor].speed_size)


def input_name(case: Case, place: str) -> str:
    """An input's short name (u_M)."""
    return stem(str(case.library.bound.model.places.inputs[place].variable))


def state_unit(case: Case, state: str) -> str:
    """What is measured in units of its size, as text."""
    return in_units(stem(state), motionless(case.library.bound.model)[state].size)


def angle_names(case: Case) -> dict[str, str]:
    """Axis -> its angle's short name (psi)."""
    return {name: entry.angle.rsplit("_", 1)[0] for name, entry in case.library.bound.model.places.axes.items()}


def rotor_name(case: Case, rotor: str) -> str:
    """The short name of a rotor's speed (omega_M), or of its input where it has no speed of its own."""
    place = case.library.bound.model.places.rotors[rotor]
    if place.drive is None:
        return str(place.variable).rsplit("_", 1)[0]
    return f"omega_{place.letter}" if place.letter else "omega"


def through(case: Case, rotor: str, s: Signals) -> Iterator[tuple[int, Array]]:
    """Where an input's change enters, and what inertia it meets there: the rotor's speed, or the axes that it pushes where the speed is no
    state."""
    library, place = case.library, case.library.bound.model.places.rotors[rotor]
    if place.drive is not None:
        yield library.states.index(str(place.speed)), np.ones_like(s.t)
        return
    axis = next(iter(place.thrusts))
    velocity = next(str(entry.velocity) for entry in library.bound.model.axes if entry.name == axis)
    yield library.states.index(velocity), s.inertia[axis]
