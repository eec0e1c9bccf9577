"""When something happened: instants and durations of events, found from the answers to a grid of steps."""

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.forward import forward, gain_of
from diagnosis.detect.linearisation import Linearisation, Scores
from diagnosis.hypothesis.case import Case, FilteredLog, told_from_s
from diagnosis.hypothesis.hypothesis import Hypothesis
from sim.effect import Effect, EffectParameter, Role, Values

Array = NDArray[np.float64]


def instants(linearisation: Linearisation, effect: Effect) -> list[dict[str, float]]:
    """Starts of an effect whose shapes are instants: the best of a grid; empty for effects without instants."""
    target = disturbed_by(linearisation.case, effect)
    if target is None or not effect.is_event:
        return []
    times_s, scores = linearisation.steps(target)
    untold = times_s <= times_s[0] + decisions.UNTOLD_S * linearisation.case.second_s  # before any reading counts
    symbol, lasts = effect.symbol(Role.INSTANT), effect.having(Role.DURATION)
    if lasts is not None:
        return [{symbol: start, lasts.symbol: duration} for start, duration in _pulses(times_s, untold, scores)]
    return [{symbol: instant} for instant in (*_jumps(linearisation, target), *_edges(times_s, untold, scores))]


def happens(effect: Effect, values: Values) -> bool:
    """Whether it is an event in these logs: not where its instant was pushed to the beginning of time, from where on it stays as it is."""
    instant, ends = effect.having(Role.INSTANT), effect.having(Role.DURATION) is not None
    return instant is not None and (ends or values[instant.symbol] > instant.lower)


def happened(case: Case, hypothesis: Hypothesis) -> bool:
    """Whether each event that does not end happens in some log while its readings count: before, it is another value of what it changes."""
    return all(
        any(_between(case, flight, hypothesis.over(flight).effects[name][instant.symbol]) for flight in case.flights)
        for name in case.added(hypothesis.effects)
        if (instant := _lasting(case.library.effects[name])) is not None
    )


def _lasting(effect: Effect) -> EffectParameter | None:
    """The instant from which on an effect stays; None of any other."""
    return None if effect.having(Role.DURATION) else effect.having(Role.INSTANT)


def _between(case: Case, flight: FilteredLog, instant_s: float) -> bool:
    t_s = flight.log.t_s
    return told_from_s(t_s, case.second_s) < instant_s < float(t_s[-1])


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


def _pulses(times_s: Array, untold: NDArray[np.bool_], scores: Scores) -> list[tuple[float, float]]:
    """Pulses from one step to a later one that take away most, in turn: when each starts and how long it lasts."""
    first, last = np.triu_indices(len(times_s), 1)
    duration_s = times_s[last] - times_s[first]
    # Over before readings count, all that is left of it is a start; what lasts half of the logs is no pulse.
    seen = (duration_s <= 0.5 * (times_s[-1] - times_s[0])) & ~untold[last]

    def norm(gram: Array) -> Array:
        return gram[first, first] + gram[last, last] - 2.0 * gram[first, last]

    whole, steps = norm(scores.gram), np.eye(len(times_s))

    def gains(left: Scores) -> Array:
        return np.where(seen, gain_of(left.score[first] - left.score[last], norm(left.gram), whole), 0.0)

    chosen = forward(scores, gains, lambda k: (steps[first[k]] - steps[last[k]])[:, None], decisions.NEXT)
    return [(float(times_s[first[k]]), float(duration_s[k])) for k in chosen]


def _edges(times_s: Array, untold: NDArray[np.bool_], scores: Scores) -> list[float]:
    """Steps that take away most, in turn: when each is."""
    whole, steps = np.diag(scores.gram), np.eye(len(times_s))

    def gains(left: Scores) -> Array:
        return np.where(untold, 0.0, gain_of(left.score, np.diag(left.gram), whole))  # before: none in this log

    return [float(times_s[k]) for k in forward(scores, gains, lambda k: steps[:, [k]], decisions.NEXT)]


def disturbed_by(case: Case, effect: Effect) -> int | None:
    """The state, or after the states the output, that an effect disturbs."""
    library, model = case.library, case.library.bound.model
    for axis in model.axes:
        if axis.name == effect.place:
            return library.states.index(str(axis.velocity))
    sensor = model.places.sensors.get(effect.place)
    return None if sensor is None else len(library.states) + library.outputs.index(sensor.output)
