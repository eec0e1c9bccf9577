"""The rest points of a plant: constant inputs and states that hold its axes at given positions."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.text.units import said, unit_of, unit_suffix
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from sim.kernel.reference import reference
from sim.model import Axis
from sim.start import start_state

MAX_ITERATIONS = 60
STARTS = (0.5, 0.75)  # of the inputs' range: a thrust by the square has no slope in the middle of a range of both signs
STEP_TOLERANCE = 1e-14
FILLED = (0.5, 0.1)  # how far above a wanted output states of its unit are tried, the first the farthest
RATE_TOLERANCE = 1e-6  # of a rate at a rest point; where there is none, the least rate is far larger
Array = NDArray[np.float64]


class NoRestPoint(BadInput):
    """Positions at which no inputs hold the axes, whatever their limits."""


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """State x0 (states,) and input u0 (inputs,) with dx/dt = 0, dry friction left out; `psi_rad` is the first axis' position."""

    psi_rad: float
    x0: Array
    u0: Array


def equilibrium(bound: BoundPlant, *positions_rad: float) -> OperatingPoint:
    """The rest point f(x0, u0) = 0 with the axes at `positions_rad`, in the order of the model; those not given are at 0.

    Solved to rounding for the states that belong to no axis (rotor speeds) and the inputs; needs as many inputs as axes. Effects
    that act on the equations are part of them, as they are at time 0; what acts on the way of a signal does not move a rest point.
    Raises BadInput naming the angle when it lies beyond a stop or needs an input beyond its limits.
    """
    return _at_positions(bound, positions_rad, _all_inputs(bound))


def _at_positions(bound: BoundPlant, positions_rad: Sequence[float], driven: Sequence[int]) -> OperatingPoint:
    """The same with the `driven` inputs alone, all others at their least effort."""
    model = bound.model
    arms = [axis for axis in model.axes if axis.position is not None]
    positions = dict(zip((axis.position for axis in arms), positions_rad, strict=False))
    for axis in arms:
        _check_stops(bound, axis, positions.get(axis.position, 0.0))
    x = np.array([positions.get(state, 0.0) for state in model.states])
    starts = _starts(bound, driven)
    found = next(filter(None, (_solve(bound, *_begin(bound, x, u, positions_rad), driven) for u in starts)), None)
    if found is None:
        raise NoRestPoint(
            "equilibrium",
            _place(bound, positions_rad),
            "no solution of f(x, u) = 0",
            "a rest point",
            "check the parameters, and whether its inputs can hold it there",
        )
    x0, u0 = found
    _check_inputs(bound, u0, _place(bound, positions_rad))
    return OperatingPoint(positions_rad[0] if positions_rad else 0.0, x0, u0)


def rest_with(
    bound: BoundPlant, places: Sequence[int], values: Sequence[float], driven: Sequence[int] | None = None
) -> OperatingPoint:
    """The rest point with the outputs at `places` at these values: of axes with a position by that, all others at 0, or where they do not
    rest there (a pulley behind a belt, a ball that cannot reach its magnet) wherever they come to rest; and of a plant without one, a
    tank or a coil, by what it measures.

    Where the `driven` inputs can hold it alone, all others are at their least effort, else all hold it together. Raises BadInput where
    there is none, or it needs an input beyond its limits.
    """
    if driven is not None and len(driven) < len(bound.model.inputs):
        with suppress(NoRestPoint):
            return _rest_with(bound, places, values, driven)
    return _rest_with(bound, places, values, _all_inputs(bound))


def _rest_with(
    bound: BoundPlant, places: Sequence[int], values: Sequence[float], driven: Sequence[int]
) -> OperatingPoint:
    wanted = dict(zip(places, values, strict=True))
    outputs = list(bound.model.outputs.values())
    at = {outputs[place]: value for place, value in wanted.items()}
    arms = [axis for axis in bound.model.axes if axis.position is not None]
    if not arms:
        return _measured(bound, wanted, driven)
    try:
        point = _at_positions(bound, [at.get(axis.position, 0.0) for axis in arms], driven)
    except BadInput:
        if all(axis.position in at for axis in arms):
            raise
        with suppress(BadInput):
            return _within_stops(bound, arms, _measured(bound, wanted, driven))
        raise
    if set(at) <= {axis.position for axis in arms} or _measures(bound, point, wanted):
        return point
    return _within_stops(bound, arms, _measured(bound, wanted, driven))


def rest_under(bound: BoundPlant, u: Array) -> OperatingPoint:
    """Where a plant that has no position comes to rest under constant inputs u (inputs,); raises NoRestPoint where it drifts on."""
    usual = {place.output: place.size for place in bound.model.places.sensors.values()}
    sizes = {index: usual.get(name, 0.0) for index, name in enumerate(bound.model.outputs)}
    found = next(filter(None, (_solve_measured(bound, {}, x, u, ()) for x in _filled(bound, sizes))), None)
    if found is None:
        where, remedy = f"plant {bound.plant.name!r} under constant inputs", "check the parameters, or close a loop"
        raise NoRestPoint("equilibrium", where, "no solution of f(x, u) = 0", "a rest point", remedy)
    return OperatingPoint(0.0, *found)


def _all_inputs(bound: BoundPlant) -> range:
    return range(len(bound.model.inputs))


def _starts(bound: BoundPlant, driven: Sequence[int]) -> list[Array]:
    """Inputs to begin from: the driven ones within their range, all others at their least effort."""
    commands = np.array([bound.commands(variable) for variable in bound.model.inputs]).reshape(-1, 2)
    least = np.clip(0.0, commands[:, 0], commands[:, 1])
    is_driven = np.isin(np.arange(len(commands)), driven)
    return [np.where(is_driven, commands @ np.array([1.0 - share, share]), least) for share in STARTS]


def _measures(bound: BoundPlant, point: OperatingPoint, wanted: Mapping[int, float]) -> bool:
    """Whether the outputs are what is wanted: one that is no axis' position may be anything where these are at rest."""
    signs = np.zeros(len(bound.model.axes))
    found = reference(bound.model).outputs(0.0, point.x0, point.u0, bound.p, signs)
    return all(abs(found[place] - value) <= RATE_TOLERANCE * max(1.0, abs(value)) for place, value in wanted.items())


def _within_stops(bound: BoundPlant, arms: Sequence[Axis], point: OperatingPoint) -> OperatingPoint:
    """The point, `psi_rad` its first axis' position; raises BadInput where an axis lies beyond a stop."""
    at = {axis.name: float(point.x0[bound.model.states.index(axis.position)]) for axis in arms}
    for axis in arms:
        _check_stops(bound, axis, at[axis.name])
    return replace(point, psi_rad=at[arms[0].name])


def _measured(bound: BoundPlant, wanted: Mapping[int, float], driven: Sequence[int]) -> OperatingPoint:
    names = list(bound.model.outputs)
    told = ", ".join(said(names[place], value) for place, value in wanted.items())
    starts = _starts(bound, driven)
    tries = [*_nominal(bound, wanted, driven), *((x, u) for x in _filled(bound, wanted) for u in starts)]
    found = next(filter(None, (_solve_measured(bound, wanted, x.copy(), u, driven) for x, u in tries)), None)
    where = f"plant {bound.plant.name!r} at {told}"
    if found is None:
        remedy = "check the parameters, and the references' range in [design]"
        raise NoRestPoint("equilibrium", where, "no solution of f(x, u) = 0", "a rest point that measures so", remedy)
    _check_inputs(bound, found[1], where)
    return OperatingPoint(0.0, *found)


def _nominal(bound: BoundPlant, wanted: Mapping[int, float], driven: Sequence[int]) -> Iterator[tuple[Array, Array]]:
    """With effects, where the nominal plant rests, as `_begin` does."""
    if bound.effects:
        with suppress(BadInput):
            nominal = _measured(without_effects(bound), wanted, driven)
            yield start_state(bound, nominal.x0), nominal.u0


def _filled(bound: BoundPlant, wanted: Mapping[int, float]) -> Iterator[Array]:
    """States to begin from: at 0, then those in the unit of a wanted output about its value, where a root has its slope."""
    names = list(bound.model.outputs)
    of_unit = {unit_suffix(names[place]): value for place, value in wanted.items()}
    yield np.zeros(len(bound.model.states))
    for share in FILLED:
        values = [of_unit.get(unit_suffix(str(state)), 0.0) for state in bound.model.states]
        yield np.array([value * (1.0 + share / (1.0 + index)) for index, value in enumerate(values)])


def _solve_measured(
    bound: BoundPlant, wanted: Mapping[int, float], x: Array, u: Array, driven: Sequence[int]
) -> tuple[Array, Array] | None:
    """No rate of any state and the wanted outputs, by the driven inputs; None where that is not found."""
    model, equations = bound.model, reference(bound.model)
    places, values = list(wanted), np.array(list(wanted.values()))
    still, states, own = np.zeros(len(model.axes)), len(x), list(driven)

    def at(unknowns: Array) -> tuple[Array, Array]:
        here = (0.0, unknowns[:states], _with(u, own, unknowns[states:]), bound.p, still)
        by_input = np.zeros((len(places), len(own)))
        slopes = np.block([[equations.A(*here), equations.B(*here)[:, own]], [equations.C(*here)[places], by_input]])
        return np.concatenate([equations.rates(*here), equations.outputs(*here)[places] - values]), slopes

    found = _newton(np.concatenate([x, u[own]]), at, _least_step)
    if found is None or not np.max(np.abs(found[1])) <= RATE_TOLERANCE * np.max(np.abs(values), initial=1.0):
        return None
    return found[0][:states], _with(u, own, found[0][states:])


def _with(u: Array, places: list[int], values: Array) -> Array:
    """The inputs with these in their places."""
    changed = u.copy()
    changed[places] = values
    return changed


def _begin(bound: BoundPlant, x: Array, u: Array, positions_rad: Sequence[float]) -> tuple[Array, Array]:
    """Where to begin: with effects, where the nominal plant rests, as a dead band is flat and a sagging supply has two answers."""
    if not bound.effects:
        return x, u
    try:
        nominal = equilibrium(without_effects(bound), *positions_rad)
    except BadInput:
        return x, u
    return start_state(bound, nominal.x0), nominal.u0


def _solve(bound: BoundPlant, x: Array, u: Array, driven: Sequence[int]) -> tuple[Array, Array] | None:
    """The rest of states and inputs from the middle of the inputs' range: thrust and damping are convex, so Newton needs no damping.

    A state whose rate is 0 wherever the axes rest (a bent cable) stays where it starts. None where there is no rest point.
    """
    model = bound.model
    arms = [axis for axis in model.axes if axis.position is not None]
    held = {variable for axis in arms for variable in (axis.position, axis.velocity)}
    free = [index for index, state in enumerate(model.states) if state not in held]
    rows = [*free, *(model.states.index(axis.velocity) for axis in arms)]
    equations, signs, own = reference(model), np.zeros(len(model.axes)), list(driven)

    def rest(unknowns: Array) -> tuple[Array, Array]:
        return _with(x, free, unknowns[: len(free)]), _with(u, own, unknowns[len(free) :])

    def at(unknowns: Array) -> tuple[Array, Array]:
        here = (0.0, *rest(unknowns), bound.p, signs)
        slopes = np.hstack([equations.A(*here)[np.ix_(rows, free)], equations.B(*here)[np.ix_(rows, own)]])
        return equations.rates(*here)[rows], slopes

    found = _newton(np.concatenate([x[free], u[own]]), at, _newton_step)
    return None if found is None or not np.max(np.abs(found[1])) <= RATE_TOLERANCE else rest(found[0])


def _newton(
    start: Array, at: Callable[[Array], tuple[Array, Array]], step_of: Callable[[Array, Array], Array]
) -> tuple[Array, Array] | None:
    """The unknowns (n,) at which `at` gives 0 and slopes (m,), (m, n), and what was left (m,) a step before; None where none are found.

    A step that leads where the equations have no value, the root of a level below 0, is taken by half, and by half again.
    """
    unknowns, last, step = start, start, np.zeros(len(start))
    for _ in range(MAX_ITERATIONS):
        with np.errstate(all="ignore"):
            wrong, slopes = at(unknowns)
        if np.all(np.isfinite(wrong)) and np.all(np.isfinite(slopes)):
            last, step = unknowns, step_of(slopes, wrong)
        elif np.any(step):
            step = 0.5 * step
        else:
            return None
        unknowns = last - step
        if np.all(np.abs(step) <= STEP_TOLERANCE * (1.0 + np.abs(unknowns))):
            return unknowns, wrong
    return None


def _newton_step(jacobian: Array, rates: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(jacobian, rates))
    except np.linalg.LinAlgError:
        return _least_step(jacobian, rates)


def _least_step(jacobian: Array, wrong: Array) -> Array:
    return np.asarray(np.linalg.lstsq(jacobian, wrong, rcond=None)[0])


def _check_stops(bound: BoundPlant, axis: Axis, position: float) -> None:
    lower = -np.inf if axis.lower is None else bound.number(axis.lower)
    upper = np.inf if axis.upper is None else bound.number(axis.upper)
    if not lower <= position <= upper:
        raise BadInput(
            f"{axis.name} {'angle' if unit_suffix(str(axis.position)) == 'rad' else 'position'}",
            f"equilibrium of plant {bound.plant.name!r}",
            _told(axis, position),
            f"{_shown(axis, lower):g} to {_told(axis, upper)}, the stops",
            "choose a position between the stops",
        )


def _check_inputs(bound: BoundPlant, u0: Array, where: str) -> None:
    for variable, value in zip(bound.model.inputs, u0, strict=True):
        lower, upper = bound.limits(variable)
        if not lower <= value <= upper:
            raise BadInput(
                f"input {variable}",
                where,
                f"{value:.4g} {unit_of(str(variable))} needed to rest there",
                f"{lower:g} to {upper:g} {unit_of(str(variable))}",
                "choose a rest that the inputs can hold",
            )


def _place(bound: BoundPlant, positions_rad: Sequence[float]) -> str:
    arms = [axis for axis in bound.model.axes if axis.position is not None]
    angles = ", ".join(map(_told, arms, positions_rad or [0.0] * len(arms)))
    return f"plant {bound.plant.name!r} at {angles}"


def _told(axis: Axis, position: float) -> str:
    """A position as a person reads it: an angle in degrees, anything else in its unit."""
    name = str(axis.position)
    return f"{_shown(axis, position):g} {'deg' if unit_suffix(name) == 'rad' else unit_of(name)}"


def _shown(axis: Axis, position: float) -> float:
    return float(np.degrees(position)) if unit_suffix(str(axis.position)) == "rad" else position
