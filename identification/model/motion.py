"""The windows of a run through the compiled variational equations: one request made ready, then one call for each window."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from sim.bind import evaluated
from sim.kernel.kernel import Kernel, kernel
from sim.model import Model
from sim.runs.sensitivities import column_names

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """y (n, outputs), dy (n, outputs, columns) and x (n, states) at all rows of a run, window after window."""

    columns: tuple[str, ...]
    y: Array
    dy: Array
    x: Array


@lru_cache(maxsize=64)
def _column_places(model: Model) -> Mapping[str, int]:
    return {name: place for place, name in enumerate(column_names(model))}


def move(
    model: Model,
    t_s: Array,
    u: Array,
    p: Array,
    windows: Sequence[slice],
    x0: Array,
    columns: tuple[str, ...],
    substeps: int = 1,
) -> Motion:
    """What sim.runs.sensitivities gives, for windows of rows, each from its own x0 (windows, states), in `substeps` steps per sample.

    t_s (n,), u (n, inputs), p (parameters,). Rows in no window are left unset; raises KeyError for a column that the model does not
    know.
    """
    if not model.states:  # a balance: all that counts is in its observation
        return Motion(columns, np.zeros((t_s.size, 0)), np.zeros((t_s.size, 0, len(columns))), np.zeros((t_s.size, 0)))
    y = np.empty((t_s.size, len(model.outputs)))
    dy, x = np.empty((*y.shape, len(columns))), np.empty((t_s.size, len(model.states)))
    rows = {"t_s": t_s, "input": np.ascontiguousarray(u), "y": y, "dy": dy, "x": x}
    request, _kept = _request(model, p, columns, substeps)
    _run(kernel(model), request, rows, windows, np.ascontiguousarray(x0))
    return Motion(columns, y, dy, x)


def _request(model: Model, p: Array, columns: tuple[str, ...], substeps: int) -> tuple[Any, Mapping[str, NDArray[Any]]]:
    """What all windows have in common, and the arrays to which it points: they must live for as long as it does."""
    compiled, places = kernel(model), _column_places(model)
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
