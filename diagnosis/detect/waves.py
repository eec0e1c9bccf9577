"""Where a sine may begin: frequencies at which something swings an axis, whatever the axis does, from the scores of steps in time; and
how many waves of a way it follows, from the answers to sines and cosines of the way."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.instants import disturbed_by
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.signals import by_step
from diagnosis.filter.filter_input import FilterInput
from diagnosis.filter.kalman import Disturbances, Pass
from sim.effect import Effect, EffectParameter, Role

Array = NDArray[np.float64]
RATES_RAD_S = np.arange(0.3, 14.0, 0.05)
APART_RAD_S = 0.3
MOST_WAVES = 48  # a turn, that are tried: nearer ones are not told apart
WAVES_APART = 0.12  # of their logarithm: three waves of those apart
MOST_PARTS = 5  # of a period of the motion, whose whole parts repeat with it


class Wave(NamedTuple):
    """A sine: how many of its radians go on a second, or on a unit of the way; its phase in rad, with which it gains most."""

    number: float
    phase: float


def wave_starts(linearisation: Linearisation, effect: Effect) -> list[dict[str, float]]:
    """Starts of an effect that swings as a sine: its likeliest waves, as they lie; empty for other effects."""
    target, phase = disturbed_by(linearisation.case, effect), effect.having(Role.PHASE)
    if target is None or phase is None:
        return []
    waves = effect.having(Role.WAVES)
    if waves is None:
        symbol, found = effect.symbol(Role.RATE), _foreign(linearisation, target, likely_waves(linearisation, target))
    else:
        symbol, found = waves.symbol, _likely_counts(linearisation, target, waves)
    return [{symbol: wave.number, phase.symbol: wave.phase} for wave in found]


def _foreign(linearisation: Linearisation, speed: int, waves: Sequence[Wave]) -> tuple[Wave, ...]:
    """Those of frequencies that are not the motion's own, nor so near to one that a fit would end there."""
    end = max(float(filter_input.t_s[-1] - filter_input.t_s[0]) for filter_input in linearisation.filter_inputs)
    near = 2.0 * np.pi / end  # nearer ones are one over so long a log
    own = [wave.number for wave in waves if _repeats(linearisation, speed, wave.number)]
    return tuple(wave for wave in waves if all(abs(wave.number - other) > near for other in own))


def _repeats(linearisation: Linearisation, speed: int, rate: float) -> bool:
    """Whether the motion itself repeats with a frequency or with a whole part of it: what repeats alike is then rather the motion's own."""
    return (
        max(_share(linearisation, speed, rate / part) for part in range(1, MOST_PARTS + 1)) > decisions.OWN_MOTION_SHARE
    )


def _share(linearisation: Linearisation, state: int, rate: float) -> float:
    """The largest share of a state's variance in one flight that swings at a frequency."""
    shares = []
    for filter_input, run in zip(linearisation.filter_inputs, linearisation.runs, strict=True):
        own = filter_input.row >= 0
        x = run.filtered[filter_input.row[own], state]
        x, phase = x[np.isfinite(x)], rate * filter_input.t_s[own][np.isfinite(x)]
        if not len(x):
            continue
        wave = np.stack([np.sin(phase), np.cos(phase), np.ones(len(phase))], axis=1)
        left = x - wave @ np.linalg.lstsq(wave, x, rcond=None)[0]
        shares.append(1.0 - float(np.var(left)) / max(float(np.var(x)), 1e-300))
    return max(shares, default=0.0)


def _likely_counts(linearisation: Linearisation, target: int, waves: EffectParameter) -> tuple[Wave, ...]:
    """Waves whose sine and cosine of the way that a target belongs to gain most, apart from one another."""
    way = _way(linearisation, target)
    if way is None:
        return ()
    fitted = np.geomspace(waves.lower, waves.upper, MOST_WAVES)
    scores = linearisation.scores_by(_sines(linearisation, target, way, fitted), target)
    pairs = np.arange(2 * MOST_WAVES).reshape(2, MOST_WAVES).T
    own, along = scores.gram[pairs[:, :, None], pairs[:, None, :]], scores.score[pairs]
    gains, phases = _pair_gains(own, along)
    best = _best(np.log(fitted), gains, WAVES_APART)
    return tuple(Wave(float(fitted[place]), float(phases[place])) for place in best)


def _sines(linearisation: Linearisation, target: int, way: int, waves: Array) -> list[Disturbances]:
    """Sines, then cosines, of a state by flight (steps, 2 k): as an acceleration, or as an error of the output."""
    moves = target < len(linearisation.case.library.states)

    def sines(filter_input: FilterInput, run: Pass) -> Disturbances:
        height = np.append(np.diff(filter_input.t_s), 0.0) if moves else np.ones(len(filter_input.t_s))
        x = np.nan_to_num(by_step(run.filtered[:, way], filter_input.row))

        def values(part: slice) -> Array:
            angle = x[part, None] * waves
            return np.asarray(height[part, None] * np.concatenate([np.sin(angle), np.cos(angle)], axis=1))

        return values

    return [
        sines(filter_input, run)
        for filter_input, run in zip(linearisation.filter_inputs, linearisation.runs, strict=True)
    ]


def _way(linearisation: Linearisation, target: int) -> int | None:
    """The state that says where a target is: an axis' position, or what an output reads; None where no state does."""
    library, model = linearisation.case.library, linearisation.case.library.bound.model
    if target < len(library.states):
        found = next((axis.position for axis in model.axes if str(axis.velocity) == library.states[target]), None)
    else:
        found = model.outputs.get(library.outputs[target - len(library.states)])
    return library.states.index(str(found)) if str(found) in library.states else None


def likely_waves(linearisation: Linearisation, target: int) -> tuple[Wave, ...]:
    """Waves in time whose sine and cosine in time gain most at a target, apart from one another."""
    times, scores = linearisation.steps(target)
    if len(times) < 8:
        return ()
    # A pulse from one instant to the next is a step up and a step down; a wave is a row of pulses.
    edge = np.eye(len(times))[:-1] - np.eye(len(times))[1:]
    gram, score = edge @ scores.gram @ edge.T, edge @ scores.score
    middle = 0.5 * (times[:-1] + times[1:])
    angle = RATES_RAD_S[:, None] * middle
    pairs = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    gains, phase = _pair_gains(pairs @ gram @ pairs.swapaxes(1, 2), pairs @ score)
    return tuple(
        Wave(float(RATES_RAD_S[place]), float(phase[place])) for place in _best(RATES_RAD_S, gains, APART_RAD_S)
    )


def _best(fitted: Array, gains: Array, apart: float) -> list[int]:
    """The places of those that gain most, at least `apart` from one another."""
    chosen: list[int] = []
    for place in np.argsort(-gains).tolist():
        if all(abs(fitted[place] - fitted[other]) > apart for other in chosen):
            chosen.append(place)
        if len(chosen) == decisions.NEXT:
            break
    return chosen


def _pair_gains(own: Array, along: Array) -> tuple[Array, Array]:
    """What a sine and a cosine together gain (k,), and the phase (k,) of the sine that they are, from their products `own` (k, 2, 2) and
    scores `along` (k, 2)."""
    ridge = 1e-9 * np.trace(own, axis1=1, axis2=2) + 1e-12
    solved = np.linalg.solve(own + ridge[:, None, None] * np.eye(2), along[:, :, None])[:, :, 0]
    return 0.5 * np.einsum("ij,ij->i", along, solved), np.arctan2(solved[:, 1], solved[:, 0])
