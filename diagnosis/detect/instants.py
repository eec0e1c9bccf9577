"""When something happened: instants and durations of events, found from the answers to a grid of steps."""

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation
from diagnosis.hypothesis.case import Case
from sim.effect import Effect, Role, Values

Array = NDArray[np.float64]


def instants(linearisation: Linearisation, effect: Effect) -> list[dict[str, float]]:
    """Starts of an effect whose shapes are instants: the best of a grid; empty for effects without instants."""
    target = disturbed_by(linearisation.case, effect)
    if target is None or not effect.is_event:
        return []
    times_s, scores = linearisation.steps(target)
    gram, score = scores.gram, scores.score
    symbol, lasts = effect.symbol(Role.INSTANT), effect.having(Role.DURATION)
    if lasts is not None:
        return [{symbol: start, lasts.symbol: duration} for start, duration in _pulses(times_s, gram, score)]
    power = score**2 / np.maximum(np.diag(gram), 1e-12)
    power[_untold(times_s)] = 0.0  # there before readings count: no event in this log
    found = [*_jumps(linearisation, target), *(float(times_s[index]) for index in _peaks(power))]
    return [{symbol: instant} for instant in found]


def happens(effect: Effect, values: Values) -> bool:
    """Whether it is an event in these logs: not where its instant was pushed to the beginning of time, from where on it stays as it is."""
    instant, ends = effect.having(Role.INSTANT), effect.having(Role.DURATION) is not None
    return instant is not None and (ends or values[instant.symbol] > instant.lower)


def _jumps(linearisation: Linearisation, target: int) -> list[float]:
    """Just before the reading of an output that is farthest from what was predicted: a jump falls between two rows, not on a grid."""
    output = target - len(linearisation.case.library.states)
    if output < 0 or linearisation.case.slots[output] < 0:
        return []
    found = []
    for run, flight in zip(linearisation.runs, linearisation.case.flights, strict=True):
        w = np.abs(np.nan_to_num(run.w[:, linearisation.case.slots[output]]))
        row = int(np.argmax(w))
        found.append((float(w[row]), 0.5 * float(flight.log.t_s[row] + flight.log.t_s[max(row - 1, 0)])))
    return [max(found)[1]]


def _pulses(times_s: Array, gram: Array, score: Array) -> list[tuple[float, float]]:
    """Pulses from one step to a later one that take away most: when each starts and how long it lasts."""
    size = len(times_s)
    first, last = np.triu_indices(size, 1)
    norm = gram[first, first] + gram[last, last] - 2.0 * gram[first, last]
    power = (score[first] - score[last]) ** 2 / np.maximum(norm, 1e-12)
    power[times_s[last] - times_s[first] > 0.5 * (times_s[-1] - times_s[0])] = 0.0
    power[_untold(times_s)[last]] = 0.0  # over before readings count: all that is left of it is a start
    order = np.argsort(-power)
    found: list[tuple[float, float]] = []
    for index in order[:200]:
        start, duration = float(times_s[first[index]]), float(times_s[last[index]] - times_s[first[index]])
        if all(abs(start - other) > decisions.EVENTS_APART_S for other, _ in found):
            found.append((start, duration))
        if len(found) == decisions.NEXT:
            break
    return found


def _untold(times_s: Array) -> NDArray[np.bool_]:
    """Which instants are before any reading counts."""
    return np.asarray(times_s <= times_s[0] + decisions.UNTOLD_S)


def _peaks(power: Array) -> list[int]:
    order: list[int] = []
    for index in np.argsort(-power).tolist():
        if all(abs(index - other) > 2 for other in order):
            order.append(index)
        if len(order) == decisions.NEXT:
            break
    return order


def disturbed_by(case: Case, effect: Effect) -> int | None:
    """The state, or after the states the output, that an effect disturbs."""
    library, model = case.library, case.library.bound.model
    for axis in model.axes:
        if axis.name == effect.place:
            return library.states.index(str(axis.velocity))
    sensor = model.places.sensors.get(effect.place)
    return None if sensor is None else len(library.states) + library.outputs.index(sensor.output)
