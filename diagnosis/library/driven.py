"""Which state an input drives first, and by how much of its rate."""

from functools import lru_cache

import sympy

from sim.model import Model


@lru_cache(maxsize=64)
def driven(model: Model, variable: sympy.Symbol) -> tuple[str, sympy.Expr] | None:
    """The first state whose rate an input changes, an axis' velocity before others, and the slope of that rate by the input; None where it
    changes none."""
    rates = {str(axis.velocity): axis.torque / axis.inertia for axis in model.axes}
    rates |= {str(state): rate for state, rate in model.rates.items()}
    slopes = ((state, sympy.diff(rate, variable)) for state, rate in rates.items())
    return next(((state, slope) for state, slope in slopes if slope != 0), None)
