"""Frequencies at which something swings an axis, whatever the axis does: from the scores of steps in time."""

import numpy as np
from numpy.typing import NDArray

from diagnosis.ground import Ground

Array = NDArray[np.float64]
RATES_RAD_S = np.arange(0.3, 14.0, 0.05)
APART_RAD_S = 0.3
MOST = 3


def likely_waves(ground: Ground, target: int) -> tuple[float, ...]:
    """The frequencies in rad/s whose sine and cosine in time gain most at a target, apart from one another."""
    times, scores = ground.steps(target)
    if len(times) < 8:
        return ()
    # A pulse from one instant to the next is a step up and a step down; a wave is a row of pulses.
    edge = np.eye(len(times))[:-1] - np.eye(len(times))[1:]
    gram, score = edge @ scores.gram @ edge.T, edge @ scores.score
    middle = 0.5 * (times[:-1] + times[1:])
    gains = _gains(gram, score, RATES_RAD_S[:, None] * middle)
    chosen: list[float] = []
    for index in np.argsort(-gains).tolist():
        rate = float(RATES_RAD_S[index])
        if all(abs(rate - other) > APART_RAD_S for other in chosen):
            chosen.append(rate)
        if len(chosen) == MOST:
            break
    return tuple(chosen)


def _gains(gram: Array, score: Array, phases: Array) -> Array:
    """What a sine and a cosine together gain, for each row of phases (waves, instants)."""
    pairs = np.stack([np.sin(phases), np.cos(phases)], axis=1)
    own, along = pairs @ gram @ pairs.swapaxes(1, 2), pairs @ score
    ridge = 1e-9 * np.trace(own, axis1=1, axis2=2) + 1e-12
    solved = np.linalg.solve(own + ridge[:, None, None] * np.eye(2), along[:, :, None])[:, :, 0]
    return np.asarray(0.5 * np.einsum("ij,ij->i", along, solved))
