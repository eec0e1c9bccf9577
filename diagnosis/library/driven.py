"""Which state an input drives first, and by how much of its rate."""

from functools import lru_cache

import sympy

from sim.model import Model


@lru_cache(maxsize=64)
def driven(model: Model, variable: sympy.Symbol) -> tuple[str, sympy.Expr] | None:
    """The speed of the rotor that an input drives, where that is a state, else the first state whose rate it changes, an axis' velocity
    before others; and the slope of that rate by the input. None where it changes none."""
    rotor = model.places.rotors.get(model.places.driven_by(variable))
    if rotor is not None and rotor.drive is not None:
        return str(rotor.speed), sympy.diff(rotor.drive, variable)
    rates = {str(axis.velocity): axis.torque / axis.inertia for axis in model.axes}
    rates |= {str(state): rate for state, rate in model.rates.items()}
    slopes = ((state, sympy.diff(rate, variable)) for state, rate in rates.items())
    return next(((state, slope) for state, slope in slopes if slope != 0), None)
