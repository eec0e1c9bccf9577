"""Outputs along windows of a run with given inputs, and their exact derivatives: one request made ready, then one call a window."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from records.errors import BadInput
from sim.bind import evaluated
from sim.kernel.kernel import Kernel, kernel
from sim.model import Model

MAX_COLUMNS = 128  # what sim/kernel/c/sensitivity.c has room for
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """y (n, outputs) without quantisation, dy (n, outputs, columns) = dy/d(column), x (n, states); `columns` names the last axis."""

    columns: tuple[str, ...]
    y: Array
    dy: Array
    x: Array


@dataclass(frozen=True, eq=False)
class Given:
    """What is run: t_s (n,), u (n, inputs) held, `windows` of their rows, each from its own row of x0 (windows, states), in `substeps`
    Runge-Kutta steps per sample."""

    t_s: Array
    u: Array
    windows: Sequence[slice]
    x0: Array
    substeps: int = 1


def whole(t_s: Array, u: Array, x0: Array) -> Given:
    """One window over all rows, from x0 (states,)."""
    return Given(t_s, u, (slice(0, t_s.size),), x0[None, :])


def sensitivities(model: Model, given: Given, p: Array, columns: tuple[str, ...]) -> Sensitivities:
    """Integrate dS/dt = A S + D, S = dx/d(columns), with the run itself, under the parameters p (parameters,).

    Rows in no window are left unset. A gain multiplies and an offset adds to an input before its limits; at a limit their derivative is
    0. Sticking, breaking away and stops are carried to first order (the instants of events move with the columns). Raises BadInput for a
    column that the model does not know, or for more than 128, and for arrays that do not fit the model.
    """
    t_s, u, x0 = given.t_s, given.u, given.x0
    shapes = {"u": (t_s.size, len(model.inputs)), "x0": (len(given.windows), len(model.states))}
    _check(model, {"u": (u, shapes["u"]), "x0": (x0, shapes["x0"])}, columns)
    if not model.states:  # a balance: all that counts is in its observation
        none = np.zeros((t_s.size, 0))
        return Sensitivities(columns, none, np.zeros((t_s.size, 0, len(columns))), none)
    y = np.empty((t_s.size, len(model.outputs)))
    dy, x = np.empty((*y.shape, len(columns))), np.empty((t_s.size, len(model.states)))
    rows = {"t_s": t_s, "input": np.ascontiguousarray(u), "y": y, "dy": dy, "x": x}
    request, _kept = _request(model, p, columns, given.substeps)
    _run(kernel(model), request, rows, given.windows, np.ascontiguousarray(x0))
    return Sensitivities(columns, y, dy, x)


@lru_cache(maxsize=64)
def column_places(model: Model) -> Mapping[str, int]:
    """All that one can differentiate by: coefficients ("K_M", "p_bM_1"), "gain.U" and "offset.U" of an input, "x0.STATE"."""
    coefficients = tuple(str(symbol) for symbol in model.parameter_symbols)
    gains = tuple(f"{kind}.{variable}" for kind in ("gain", "offset") for variable in model.inputs)
    names = (*coefficients, *gains, *(f"x0.{state}" for state in model.states))
    return {name: place for place, name in enumerate(names)}


def _request(model: Model, p: Array, columns: tuple[str, ...], substeps: int) -> tuple[Any, Mapping[str, NDArray[Any]]]:
    """What all windows have in common, and the arrays to which it points: they must live for as long as it does."""
    compiled, places = kernel(model), column_places(model)
    lower, upper = _slopes(model, p)
    column = np.array([places[name] for name in columns], dtype=np.int32)
    kept: dict[str, NDArray[Any]] = {"p": p, "lower_slope": lower, "upper_slope": upper, "column": column}
    request = compiled.ffi.new("sensitivity_request *")
    for name, array in kept.items():
        setattr(request, name, compiled.pointer(array))
    request.substeps, request.columns = substeps, len(columns)
    return request, kept


def _run(compiled: Kernel, request: Any, rows: Mapping[str, Array], windows: Sequence[slice], starts: Array) -> None:
    """One call for each window; its part of the arrays `rows` (n, ...) follows from where these begin."""
    bases = {name: compiled.ffi.cast("double *", array.ctypes.data) for name, array in rows.items()}
    x0, sensitivity_run = compiled.ffi.cast("double *", starts.ctypes.data), compiled.sensitivity.sensitivity_run
    for number, window in enumerate(windows):
        for name, array in rows.items():
            setattr(request, name, bases[name] + window.start * array[0].size)
        request.x0 = x0 + number * starts.shape[1]
        request.samples = window.stop - window.start
        sensitivity_run(request)


def _slopes(model: Model, p: Array) -> tuple[Array, Array]:
    """d(lower stop)/dp and d(upper stop)/dp of each axis, (axes, parameters)."""
    entries = _stop_slopes(model)
    result = np.zeros((2, max(1, len(model.axes)), p.size))
    for side, axis, column, slope in entries:
        result[side, axis, column] = evaluated(model, p, slope)
    return result[0], result[1]


@lru_cache(maxsize=64)
def _stop_slopes(model: Model) -> tuple[tuple[int, int, int, sympy.Expr], ...]:
    found = []
    for number, axis in enumerate(model.axes):
        for side, stop in enumerate((axis.lower, axis.upper)):
            for column, symbol in enumerate(model.parameter_symbols):
                slope = sympy.diff(stop, symbol) if stop is not None else sympy.Integer(0)
                if slope != 0:
                    found.append((side, number, column, slope))
    return tuple(found)


def _check(model: Model, shapes: Mapping[str, tuple[Array, tuple[int, int]]], columns: tuple[str, ...]) -> None:
    where, known = "sensitivities", column_places(model)
    for name, (array, expected) in shapes.items():
        if array.shape != expected:
            raise BadInput(name, where, f"shape {array.shape}", f"shape {expected}", "check the arguments' order")
    for name in columns:
        if name not in known:
            raise BadInput("column", where, repr(name), f"one of {', '.join(known)}", "name a coefficient or state")
    if len(columns) > MAX_COLUMNS:
        raise BadInput("columns", where, f"{len(columns)}", f"at most {MAX_COLUMNS}", "ask in two calls")
