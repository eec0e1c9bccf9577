"""New data against old: parameters that move by more than what was said of them before allows."""

from dataclasses import dataclass

import numpy as np

from identification import thresholds
from identification.fit.belief import Belief


@dataclass(frozen=True)
class Contradiction:
    """A parameter that this stage's data pull away from what earlier data said: by how many standard deviations, from where to where."""

    name: str
    sds: float
    before: float
    after: float


def contradictions(before: Belief, after: Belief) -> tuple[Contradiction, ...]:
    """Parameters that moved by more than new data can explain: the variance of an update is that before less that after."""
    found = []
    for place, name in enumerate(before.names):
        spread = before.covariance[place, place] - after.covariance[place, place]
        moved = float(after.mean[place] - before.mean[place])
        sds = abs(moved) / float(np.sqrt(max(spread, 1e-4 * before.covariance[place, place])))
        if sds > thresholds.CONTRADICTS and abs(moved) > thresholds.NO_NEWS * before.sd[place]:
            found.append(Contradiction(name, sds, float(before.mean[place]), float(after.mean[place])))
    return tuple(found)
