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
    gains = np.array([_gain(gram, score, rate * middle) for rate in RATES_RAD_S])
    chosen: list[float] = []
    for index in np.argsort(-gains).tolist():
        rate = float(RATES_RAD_S[index])
        if all(abs(rate - other) > APART_RAD_S for other in chosen):
            chosen.append(rate)
        if len(chosen) == MOST:
            break
    return tuple(chosen)


def _gain(gram: Array, score: Array, phase: Array) -> float:
    pair = np.stack([np.sin(phase), np.cos(phase)])
    own, along = pair @ gram @ pair.T, pair @ score
    return 0.5 * float(along @ np.linalg.solve(own + 1e-9 * np.trace(own) * np.eye(2) + 1e-12 * np.eye(2), along))
