"""Outputs of a run with given inputs, and their exact derivatives, for identification and diagnosis."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy
from numpy.typing import ArrayLike, NDArray

from records.errors import BadInput
from sim.added_effects import library, with_values
from sim.bind import BoundPlant
from sim.effect import coefficient
from sim.kernel.kernel import kernel
from sim.model import Model
from sim.paths.path import Trace
from sim.runs.compiled_run import run_equations
from sim.runs.on_the_way import arriving, readings
from sim.start import start_state

MAX_COLUMNS = 128
DIFFERENCE = 0.002  # of a reference size: how far the second run of a difference goes
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """y (n, outputs) without quantisation, dy (n, outputs, columns) = dy/d(column), x (n, states); `columns` names the last axis."""

    columns: tuple[str, ...]
    y: Array
    dy: Array
    x: Array


@lru_cache(maxsize=64)
def column_names(model: Model) -> tuple[str, ...]:
    """All that one can differentiate by: coefficients ("K_M", "p_bM_1"), "gain.U" and "offset.U" of an input, "x0.STATE"."""
    coefficients = tuple(str(symbol) for symbol in model.parameter_symbols)
    gains = tuple(f"{kind}.{variable}" for kind in ("gain", "offset") for variable in model.inputs)
    return (*coefficients, *gains, *(f"x0.{state}" for state in model.states))


def sensitivities(
    bound: BoundPlant,
    t_s: ArrayLike,
    u: ArrayLike,
    x0: ArrayLike,
    columns: tuple[str, ...],
    *,
    p: ArrayLike | None = None,
    substeps: int = 1,
) -> Sensitivities:
    """Integrate dS/dt = A S + D, S = dx/d(columns), with the run itself: t_s (n,), u (n, inputs) held, x0 (states,), p (k,).

    A gain multiplies and an offset adds to an input before its limits; at a limit their derivative is 0. Sticking, breaking away and
    stops are carried to first order (the instants of events move with the columns). Parameters of effects on the way of a signal
    (path_columns) are differentiated by a second run each; readings in steps and play are passed over. Raises BadInput for an unknown
    column, or more than 128.
    """
    start = start_state(bound, x0)
    if not bound.input_path and not bound.output_path:
        return _of_equations(bound, t_s, u, start, columns, p, substeps)
    way, moved = arriving(bound, t_s, u), path_columns(bound)
    _check_columns(bound, columns, (*column_names(bound.model), *moved))
    smooth = tuple(name for name in columns if name not in moved)
    found = _of_equations(bound, way.t_s, way.u, start, smooth, p, substeps)
    numbers = np.asarray(bound.p if p is None else p, dtype=float)
    y, slopes = readings(bound, way.t_s, found.x, numbers)[way.rows], found.dy
    for stage in bound.output_path:
        if stage.linear and smooth:
            one = slopes[:, stage.output]
            slopes[:, stage.output] = stage(Trace(way.t_s, one, np.gradient(one, way.t_s, axis=0)), None)[0].y
    dy = np.empty((len(way.rows), y.shape[1], len(columns)))
    for place, name in enumerate(columns):
        if name in moved:
            dy[:, :, place] = _by_difference(bound, moved[name], (t_s, u, start, numbers, substeps), y)
        else:
            dy[:, :, place] = slopes[way.rows, :, smooth.index(name)]
    return Sensitivities(columns, y, dy, found.x[way.rows])


def path_columns(bound: BoundPlant) -> Mapping[str, tuple[str, str]]:
    """The parameters of a plant's effects that no equation carries: effect and symbol by the name of their column."""
    in_equations = {str(symbol) for symbol in bound.model.parameter_symbols}
    names = {
        coefficient(effect, symbol): (effect, symbol) for effect, given in bound.effects.items() for symbol in given
    }
    return {column: pair for column, pair in names.items() if column not in in_equations}


def _by_difference(
    bound: BoundPlant, which: tuple[str, str], run: tuple[ArrayLike, ArrayLike, Array, Array, int], y: Array
) -> Array:
    """dy/d(parameter) of an effect on the way of a signal, from a second run a little further towards its reference."""
    effect, symbol = which
    entry = library(bound)[effect].parameter[symbol]
    value = bound.effects[effect][symbol].values[0]
    step = DIFFERENCE * (entry.reference - entry.first)
    if not entry.lower <= value + step <= entry.upper:
        step = -step
    other = with_values(bound, {effect: {symbol: value + step}})
    t_s, u, x0, p, substeps = run
    way = arriving(other, t_s, u)
    moved = run_equations(other, way.t_s, x0, way.u, p=p, substeps=substeps, keep="x").x
    assert moved is not None
    return np.asarray((readings(other, way.t_s, moved, p)[way.rows] - y) / step)


def _of_equations(
    bound: BoundPlant,
    t_s: ArrayLike,
    u: ArrayLike,
    x0: Array,
    columns: tuple[str, ...],
    p: ArrayLike | None,
    substeps: int,
) -> Sensitivities:
    """The same without what signals pass on their way."""
    model, compiled = bound.model, kernel(bound.model)
    known = column_names(model)
    _check_columns(bound, columns, known)
    times = np.ascontiguousarray(t_s, dtype=float)
    arrays: dict[str, NDArray[np.float64] | NDArray[np.int32]] = {
        "t_s": times,
        "p": np.ascontiguousarray(bound.p if p is None else p, dtype=float),
        "x0": np.ascontiguousarray(x0, dtype=float),
        "input": np.ascontiguousarray(u, dtype=float),
        "column": np.array([known.index(name) for name in columns], dtype=np.int32),
        "lower_slope": _stop_slopes(bound, 0),
        "upper_slope": _stop_slopes(bound, 1),
        "y": np.empty((times.size, len(model.outputs))),
        "dy": np.empty((times.size, len(model.outputs), len(columns))),
        "x": np.empty((times.size, len(model.states))),
    }
    _check_shapes(model, arrays)
    request = compiled.ffi.new("sensitivity_request *")
    for name, array in arrays.items():
        setattr(request, name, compiled.pointer(array))
    request.samples, request.substeps, request.columns = times.size, substeps, len(columns)
    compiled.sensitivity.sensitivity_run(request)
    return Sensitivities(
        columns, np.asarray(arrays["y"], float), np.asarray(arrays["dy"], float), np.asarray(arrays["x"], float)
    )


def _stop_slopes(bound: BoundPlant, side: int) -> Array:
    """d(stop)/dp, shape (axes, parameters); 0 where there is no stop."""
    model = bound.model
    slopes = np.zeros((max(1, len(model.axes)), len(model.parameter_symbols)))
    for row, column, slope in _stop_derivatives(model, side):
        slopes[row, column] = bound.number(slope)
    return slopes


@lru_cache(maxsize=128)
def _stop_derivatives(model: Model, side: int) -> tuple[tuple[int, int, sympy.Expr], ...]:
    limits = [(axis.lower, axis.upper)[side] for axis in model.axes]
    stops = [sympy.Integer(0) if limit is None else sympy.sympify(limit) for limit in limits]
    return tuple(
        (row, column, sympy.diff(stop, symbol))
        for row, stop in enumerate(stops)
        for column, symbol in enumerate(model.parameter_symbols)
        if stop.has(symbol)
    )


def _check_columns(bound: BoundPlant, columns: tuple[str, ...], known: tuple[str, ...]) -> None:
    for name in columns:
        if name not in known:
            raise BadInput(
                "column", "sensitivities", repr(name), f"one of {', '.join(known)}", "name a coefficient or state"
            )
    if len(columns) > MAX_COLUMNS:
        raise BadInput("columns", "sensitivities", f"{len(columns)}", f"at most {MAX_COLUMNS}", "ask in two calls")


def _check_shapes(model: Model, arrays: Mapping[str, NDArray[np.float64] | NDArray[np.int32]]) -> None:
    shapes = {
        "p": (len(model.parameter_symbols),),
        "x0": (len(model.states),),
        "input": (arrays["t_s"].size, len(model.inputs)),
    }
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise BadInput(
                name, "sensitivities", f"shape {arrays[name].shape}", f"shape {shape}", "check the arguments' order"
            )
