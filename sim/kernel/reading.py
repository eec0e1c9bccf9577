"""The outputs of a model and their rates as a function of states, for what outputs pass on their way."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import sympy
from numpy.typing import NDArray

from sim.model import TIME, Model

Array = NDArray[np.float64]


@lru_cache(maxsize=128)
def reading(model: Model) -> Callable[[Array, Array, Array], tuple[Array, Array]]:
    """A function of t_s (n,), x (n, states), p (k,) that gives the outputs and their rates, both (n, outputs).

    The rates follow from the rates of the states that are no axis' velocity; an output that is a velocity has none here (0), nor one
    whose rate jumps with an input.
    """
    outputs = list(model.outputs.values())
    rates = [_rate(y, model) for y in outputs]
    function = sympy.lambdify(
        [TIME, *model.states, *model.parameter_symbols], [*outputs, *rates], modules="numpy", cse=True
    )

    def evaluate(t_s: Array, x: Array, p: Array) -> tuple[Array, Array]:
        columns = [np.broadcast_to(np.asarray(column, dtype=float), t_s.shape) for column in function(t_s, *x.T, *p)]
        both = np.stack(columns, axis=-1)
        return both[:, : len(outputs)].copy(), both[:, len(outputs) :].copy()

    return evaluate


def _rate(y: sympy.Expr, model: Model) -> sympy.Expr:
    rate = sum((sympy.diff(y, state) * rate for state, rate in model.rates.items()), sympy.Integer(0))
    return sympy.Integer(0) if rate.free_symbols & set(model.inputs) else rate
