"""The equations as plain NumPy functions: the readable reference that the compiled kernels are held against."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy
from numpy.typing import ArrayLike, NDArray

from sim.model import TIME, Model
from sim.slopes import jacobian

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reference:
    """Rates and Jacobians of a model, each a function of (t_s, x, u, p, signs) with shapes (), (n,), (m,), (k,), (axes,).

    `rates` returns dx/dt (n,); `A` its Jacobian in x (n, n), `B` in u (n, m) and `D_p` in p (n, k), `C` that of the outputs (r, n).
    `signs` holds the direction of dry friction of each axis; 0 leaves it out, as a linearisation must (sgn has no slope at rest).
    """

    rates: Callable[..., Array]
    A: Callable[..., Array]
    B: Callable[..., Array]
    D_p: Callable[..., Array]
    C: Callable[..., Array]


@lru_cache(maxsize=64)
def reference(model: Model) -> Reference:
    """Derive rates and Jacobians from the symbolic equations of `model`, once for each model object."""
    rates = model.state_rates()
    outputs = sympy.Matrix(list(model.outputs.values()))
    return Reference(
        rates=_function(model, rates, flat=True),
        A=_function(model, jacobian(rates, model.states)),
        B=_function(model, jacobian(rates, model.inputs)),
        D_p=_function(model, jacobian(rates, model.parameter_symbols)),
        C=_function(model, jacobian(outputs, model.states)),
    )


def _function(model: Model, expression: sympy.Matrix, *, flat: bool = False) -> Callable[..., Array]:
    arguments = [TIME, model.states, model.inputs, model.parameter_symbols, model.friction_signs]
    raw = sympy.lambdify(arguments, expression, modules="numpy", cse=True)

    def evaluate(t_s: float, x: ArrayLike, u: ArrayLike, p: ArrayLike, signs: ArrayLike) -> Array:
        result = np.asarray(raw(t_s, x, u, p, signs), dtype=float)
        return result.ravel() if flat else result

    return evaluate
