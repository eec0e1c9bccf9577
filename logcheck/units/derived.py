"""Units of references, rates and rotor speeds, by what they should equal: an angle, its derivative, the plant's own equation."""

from collections.abc import Callable, Iterator, Mapping
from functools import cache

import numpy as np
import sympy

from logcheck import thresholds
from logcheck.finding import Array, Found
from logcheck.units.slip import slip
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import reference_name
from sim.model import Model

SLOPES = {np.degrees(1.0): "degrees", 30.0 / np.pi: "rpm", 0.5 / np.pi: "turns"}  # number written for 1 rad or 1 rad/s
SMOOTHING_S = 0.1
EXPECTED = "radians and seconds"


def reference_unit(log: RunLog, name: str, column: str) -> Iterator[Found]:
    """A closed loop holds its angle near the reference: a reference in degrees is 57 times the angle."""
    other = reference_name(column)
    if log.loop != "closed" or other not in log.extra:
        return
    unit = _unit_of(log.column(column), log.extra[other], thresholds.FOLLOWS_CORRELATION, thresholds.FOLLOWS_FACTOR)
    if unit == "degrees":
        sentence = f"{other} is in {unit}, by {column} which follows it"
        yield slip(log, name, other, sentence, EXPECTED, f"convert {other}")


def rate_unit(log: RunLog, name: str, model: Model) -> Iterator[Found]:
    """A logged rate against the differentiated angle."""
    for axis in model.axes:
        velocity, position = str(axis.velocity), str(axis.position)
        if velocity in log.extra and position in log.columns.outputs:
            angle, rate = _differentiated(log, position, velocity)
            unit = _unit_of(angle, rate)
            if unit is not None:
                sentence = f"{velocity} is in {unit} a second or minute, by {position}"
                yield slip(log, name, velocity, sentence, EXPECTED, f"convert {velocity}")


def rotor_unit(log: RunLog, name: str, bound: BoundPlant, limits: Mapping[str, tuple[float, float]]) -> Iterator[Found]:
    """A rotor's speed against its own equation: with the right unit, its rate is what the equation gives."""
    model = bound.model
    own = {axis.velocity for axis in model.axes} | {axis.position for axis in model.axes}
    for state in model.states:
        column = str(state)
        if state in own or column not in log.extra or not column.endswith("_rad_s"):
            continue
        if not np.isfinite(log.extra[column]).any():
            continue
        inputs = [u for u in model.inputs if u in model.rates[state].free_symbols]
        if len(inputs) != 1 or not model.rates[state].free_symbols <= {state, *inputs, *model.parameter_symbols}:
            continue
        speed, u = log.extra[column], np.clip(log.column(str(inputs[0])), *limits[str(inputs[0])])
        rate = _rate_function(model, state, inputs[0])
        errors = {scale: _balance(log, speed / scale, rate(speed / scale, u, *bound.p)) for scale in (1.0, *SLOPES)}
        best = min(errors, key=lambda scale: errors[scale])
        if best != 1.0 and errors[best] * thresholds.CLEARLY_BETTER < errors[1.0]:
            sentence = f"{column} is in {SLOPES[best]} a second or minute, by its own equation"
            yield slip(log, name, column, sentence, EXPECTED, f"convert {column}")


@cache
def _rate_function(model: Model, state: sympy.Symbol, u: sympy.Symbol) -> Callable[..., Array]:
    """The rate of a state over arrays of it and of its input, and the parameters."""
    function: Callable[..., Array] = sympy.lambdify((state, u, *model.parameter_symbols), model.rates[state], "numpy")
    return function


def _balance(log: RunLog, speed: Array, expected: Array) -> float:
    """Mean error of the rotor's equation over tenths of a second, relative to the speed [1/s]."""
    stride = max(1, round(SMOOTHING_S / log.sample_period_s))
    passed_s = log.t_s[stride:] - log.t_s[:-stride]
    found = (speed[stride:] - speed[:-stride]) / np.where(passed_s > 0.0, passed_s, np.inf)
    sums = np.concatenate([[0.0], np.cumsum(np.nan_to_num(expected))])
    error = np.abs(found - (sums[stride:-1] - sums[: -stride - 1]) / stride)
    return float(np.nanmean(error)) / max(float(np.nanmean(np.abs(speed))), 1e-12)


def _differentiated(log: RunLog, position: str, velocity: str) -> tuple[Array, Array]:
    """The angle's rate and the logged one, both over SMOOTHING_S."""
    stride = max(1, round(SMOOTHING_S / log.sample_period_s))
    angle, rate = log.column(position), log.extra[velocity]
    passed_s = log.t_s[stride:] - log.t_s[:-stride]
    sums = np.concatenate([[0.0], np.cumsum(np.nan_to_num(rate))])
    mean = (sums[stride:-1] - sums[: -stride - 1]) / stride
    return (angle[stride:] - angle[:-stride]) / np.where(passed_s > 0.0, passed_s, np.inf), mean


def _unit_of(
    expected: Array,
    found: Array,
    correlation: float = thresholds.LEAST_CORRELATION,
    close: float = thresholds.UNIT_FACTOR,
) -> str | None:
    """The unit in which `found` would equal `expected`; None for radians, or where the two have too little to do with each other."""
    present = np.isfinite(expected) & np.isfinite(found)
    one, other = expected[present], found[present]
    if one.size < thresholds.LEAST_MOVING_ROWS or one.std() == 0.0 or other.std() == 0.0:
        return None
    if abs(float(np.corrcoef(one, other)[0, 1])) < correlation:
        return None
    slope = float(other.std() / one.std())
    return next((unit for value, unit in SLOPES.items() if value / close < slope < value * close), None)
