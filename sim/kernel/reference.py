"""The equations as plain NumPy functions: the readable reference that the compiled kernels are held against."""

from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np
import sympy
from numpy.typing import ArrayLike, NDArray

from sim.model import TIME, Model
from sim.symbolic.slopes import jacobian

Array = NDArray[np.float64]
Function = Callable[..., Array]


class Reference:
    """Rates and Jacobians of a model, each a function of (t_s, x, u, p, signs) with shapes (), (n,), (m,), (k,), (axes,).

    `signs` holds the direction of dry friction of each axis; 0 leaves it out, as a linearisation must (sgn has no slope at rest).
    Each is derived when it is first asked for: a rest point needs no slopes by parameters.
    """

    def __init__(self, model: Model) -> None:
        self._model = model

    @cached_property
    def rates(self) -> Function:
        """dx/dt (n,)."""
        return _function(self._model, self._rates, flat=True)

    @cached_property
    def A(self) -> Function:
        """Jacobian (n, n) of the rates in x."""
        return _function(self._model, jacobian(self._rates, self._model.states))

    @cached_property
    def B(self) -> Function:
        """Jacobian (n, m) of the rates in u."""
        return _function(self._model, jacobian(self._rates, self._model.inputs))

    @cached_property
    def D_p(self) -> Function:
        """Jacobian (n, k) of the rates in p."""
        return _function(self._model, jacobian(self._rates, self._model.parameter_symbols))

    @cached_property
    def outputs(self) -> Function:
        """What is measured (r,)."""
        return _function(self._model, self._outputs, flat=True)

    @cached_property
    def C(self) -> Function:
        """Jacobian (r, n) of the outputs in x."""
        return _function(self._model, jacobian(self._outputs, self._model.states))

    @cached_property
    def _outputs(self) -> sympy.Matrix:
        return sympy.Matrix(list(self._model.outputs.values()))

    @cached_property
    def _rates(self) -> sympy.Matrix:
        return self._model.state_rates()


@lru_cache(maxsize=64)
def reference(model: Model) -> Reference:
    """The functions of `model`, once for each model object."""
    return Reference(model)


def _function(model: Model, expression: sympy.Matrix, *, flat: bool = False) -> Function:
    arguments = [TIME, model.states, model.inputs, model.parameter_symbols, model.friction_signs]
    raw = sympy.lambdify(arguments, expression, modules="numpy", cse=True)

    def evaluate(t_s: float, x: ArrayLike, u: ArrayLike, p: ArrayLike, signs: ArrayLike) -> Array:
        result = np.asarray(raw(t_s, x, u, p, signs), dtype=float)
        return result.ravel() if flat else result

    return evaluate
