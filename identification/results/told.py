"""What the data tell too poorly, and what then counts: the one rule of what an identification writes.

What is written is one model with one covariance. Estimates of one fit are correlated, so none of them is ever put back by itself: the
others would then be of another model, which fits nothing. A parameter that the data tell poorly counts instead with what the plant file
knows of it, value and sd, as one more reading of the same fit,

(1)  V(theta) + (theta - stated)^T S^-1 (theta - stated)    over those parameters, S their covariance in the plant file

and all others move with it as far as they hang together. Where the file states no sd of it, it was freed against the file's word:
nothing more is known, and the joint estimate stands.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from identification import thresholds
from identification.fit.belief import NOTHING, Belief
from identification.results.plant_file import numbers
from identification.stages.estimate import Data, Estimate
from records.plant import Plant


@dataclass(frozen=True)
class ByData:
    """What the data alone say of a parameter: value, sd, the sd had it not been given a size, and whether that tells it at all."""

    value: float
    sd: float
    loose_sd: float
    told: bool


def by_data(
    plant: Plant, belief: Belief, loose: Mapping[str, float], factors: Mapping[str, float]
) -> dict[str, ByData]:
    """Each parameter of the belief; `factors` are half the widths of the intervals in sd.

    What the plant file states as 0 has no size by which to be called poor.
    """
    stated, found = numbers(plant), {}
    for name, value, sd in zip(belief.names, belief.mean.tolist(), belief.sd.tolist(), strict=True):
        known, known_sd, _ = stated[name]
        size, loose_sd = max(abs(known), abs(value), known_sd), max(sd, loose[name])
        told = factors[name] * loose_sd < thresholds.FARTHEST * size or known == 0.0
        found[name] = ByData(value, sd, loose_sd, told)
    return found


def of_file(plant: Plant, names: Sequence[str], stages: Sequence[tuple[Data, Estimate]] = ()) -> Belief:
    """What the plant file knows of these parameters, S of (1), without those that have no sd there.

    One that was fresh to no stage came with the file's knowledge (--prior), which counts once.
    """
    stated, fresh = numbers(plant), {name for _, stage in stages for name in stage.fresh}
    known = tuple(name for name in names if stated[name][1] > 0.0 and (name in fresh or not stages))
    if not known:
        return NOTHING
    value, sd = (np.array([stated[name][place] for name in known]) for place in (0, 1))
    spread = np.eye(len(known)) if plant.correlation is None else plant.correlation.spread_over(known)
    return Belief(known, value, spread * np.outer(sd, sd))


def combined(belief: Belief, known: Belief) -> Belief:
    """(1) where all equations are linear: what is known of some parameters moves the belief of all."""
    if not known.names:
        return belief
    places = [belief.names.index(name) for name in known.names]
    C = belief.covariance
    gain = np.linalg.solve(C[np.ix_(places, places)] + known.covariance, C[places]).T
    mean = belief.mean + gain @ (known.mean - belief.mean[places])
    covariance = C - gain @ C[places]
    return Belief(belief.names, mean, (covariance + covariance.T) / 2.0)
