"""What a log without any gap would show: replicas of its innovations with the encoders' own rounding, and the tail of their largest score.

Each replica flies the log's own way, moved by less than an encoder step, under new noise and with coefficients drawn from their spread;
it goes through the same filter, linearised. So rounding is not taken for white noise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.linearisation import Linearisation
from diagnosis.hypothesis.hypothesis import noise_of
from diagnosis.library.reading_noise import state_of
from jobs.thread_map import thread_map

Array = NDArray[np.float64]
REPLICA_SEED = 20
REPLICAS = 48  # two moments of a Gumbel law need no more


@dataclass(frozen=True)
class Tail:
    """A Gumbel law for the largest gain of a log without gap: place and scale, by moments of the replicas."""

    place: float
    scale: float

    def probability(self, gain: float) -> float:
        """The chance of so large a gain or a larger one."""
        return float(-np.expm1(-np.exp(-(gain - self.place) / self.scale)))


def tail_of(largest: Array) -> Tail:
    """The law of the largest gains of replicas (count,)."""
    scale = max(float(np.std(largest)) * np.sqrt(6.0) / np.pi, 0.5)
    return Tail(float(np.mean(largest)) - 0.5772 * scale, scale)


def replicas(linearisation: Linearisation) -> Array:
    """Whitened innovations (rows, REPLICAS) of flights without gap, coefficients drawn from their spread."""
    rng = np.random.default_rng(REPLICA_SEED)
    flights = range(len(linearisation.filter_inputs))
    parts = thread_map(
        lambda index: _flight(linearisation, index, REPLICAS, np.random.default_rng((REPLICA_SEED, index))), flights
    )
    drawn = rng.standard_normal((linearisation.slopes.shape[1], REPLICAS))
    spread = linearisation.case.spread
    return np.asarray(np.concatenate(parts) + linearisation.slopes @ (drawn if spread is None else spread @ drawn))


def _flight(linearisation: Linearisation, index: int, count: int, rng: np.random.Generator) -> Array:
    case, filter_input, run = linearisation.case, linearisation.filter_inputs[index], linearisation.runs[index]
    library, flight = case.library, case.flights[index]
    compiled = library.compiled(linearisation.fit.hypothesis.effects)
    noise = noise_of(case, compiled, flight, linearisation.fit.hypothesis)
    states = linearisation.filter.states
    moving = [
        library.states.index(str(axis.velocity)) for axis in library.bound.model.axes if axis.name not in flight.locked
    ]
    pushed = [library.effects[name] for name in linearisation.fit.hypothesis.effects if library.effects[name].is_noise]
    moving += [compiled.states.index(e.filter_state.name) for e in pushed if e.filter_state is not None]
    moving += [compiled.states.index(state_of(output)) for output in linearisation.fit.hypothesis.reading_noise]
    measured = [place for place, slot in enumerate(case.slots) if slot >= 0]
    targets = [*moving, *(states + place for place in measured)]
    values = np.empty((len(filter_input.t_s), len(targets), count))
    h = np.append(np.diff(filter_input.t_s), 0.0)[:, None]
    for row, state in enumerate(moving):
        values[:, row] = rng.standard_normal((len(h), count)) * np.sqrt(noise.q[state] * h)
    for row, place in enumerate(measured, len(moving)):
        values[:, row] = _read(linearisation, index, place, count, rng)
    dw = linearisation.filter.response(filter_input, run, values.__getitem__, targets, case.slots)
    return dw.reshape(-1, count)


def _read(linearisation: Linearisation, index: int, place: int, count: int, rng: np.random.Generator) -> Array:
    """Errors of readings (steps, count): rounding along the log's own way, moved at random, noise beyond it; and of edges their own."""
    library, filter_input = linearisation.case.library, linearisation.filter_inputs[index]
    name = library.outputs[place]
    step = library.bound.plant.sensors.get(name, 0.0)
    beyond = filter_input.single[place] - step**2 / 12.0
    error = rng.standard_normal((len(filter_input.t_s), count)) * np.sqrt(beyond if beyond > 1e-3 * step**2 else 0.0)
    if step <= 0.0 or name not in library.bound.model.outputs:
        return np.where(np.isfinite(filter_input.y[:, place])[:, None], error, 0.0)
    symbol = str(library.bound.model.outputs[name])
    column = library.states.index(symbol) if symbol in library.states else -1
    way = (
        filter_input.y[:, place]
        if column < 0
        else linearisation.runs[index].filtered[np.maximum(filter_input.row, 0), column]
    )
    # How far the way itself is off nobody knows: least where a steady speed makes rounding beat with the samples.
    off = rng.uniform(0.0, 0.3 * step, count) * _wander(len(way), count, rng)
    exact = np.nan_to_num(way)[:, None] + rng.uniform(0.0, step, count) + off
    error += np.round(exact / step) * step - exact
    sharp = filter_input.r[:, place] < filter_input.single[place]
    error[sharp] = rng.uniform(-0.5, 0.5, (int(sharp.sum()), count)) * np.sqrt(
        12.0 * filter_input.r[sharp, place, None]
    )
    return np.where(np.isfinite(filter_input.y[:, place])[:, None], error, 0.0)


def _wander(steps: int, count: int, rng: np.random.Generator) -> Array:
    """A slow random way of about one unit, by straight lines between points a second apart."""
    points = rng.standard_normal((steps // 100 + 2, count))
    at = np.linspace(0.0, len(points) - 1.001, steps)
    low = at.astype(int)
    share = (at - low)[:, None]
    return np.asarray(points[low] * (1.0 - share) + points[low + 1] * share)
