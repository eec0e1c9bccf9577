"""What a sensor shows that is no state: a force, a balance of torques, each an expression of states, inputs and parameters."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy
from numpy.typing import NDArray

from sim.model import Model
from sim.symbolic.slopes import jacobian

Array = NDArray[np.float64]
Function = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True, eq=False)
class Observation:
    """h(x, u, p) for n samples at once: `value` (n, k), `by_state` (n, k, states), `by_parameter` (n, k, parameters).

    x is (n, states), u (n, inputs), p (parameters,).
    """

    expressions: tuple[sympy.Expr, ...]
    value: Function
    by_state: Function
    by_parameter: Function


@lru_cache(maxsize=64)
def observation(model: Model, expressions: tuple[sympy.Expr, ...]) -> Observation:
    """Derive values and Jacobians of the expressions over the symbols of `model`."""
    return Observation(
        expressions,
        _function(model, sympy.Matrix(expressions)),
        _function(model, jacobian(expressions, model.states), 2),
        _function(model, jacobian(expressions, model.parameter_symbols), 2),
    )


def _function(model: Model, matrix: sympy.Matrix, axes: int = 1) -> Function:
    """The entries as one NumPy function of columns; an entry that is constant is spread over the samples."""
    entries = sympy.lambdify(
        [model.states, model.inputs, model.parameter_symbols], list(matrix), modules="numpy", cse=True
    )
    shape = matrix.shape[:axes]

    def evaluate(x: Array, u: Array, p: Array) -> Array:
        if not matrix.shape[1]:
            return np.zeros((len(u), *shape))
        values = entries(x.T, u.T, p)
        spread = np.stack([np.broadcast_to(np.asarray(value, dtype=float), len(u)) for value in values], axis=-1)
        return np.asarray(spread.reshape(len(u), *shape), dtype=float)

    return evaluate
