"""What an effect outside the library looks like: where it acts and on what it depends, by which forms explain the gap best."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect import LEAST_LEFT, Detection
from diagnosis.generic import Form
from diagnosis.ground import Scores

Array = NDArray[np.float64]
RIDGE = 1e-6
NATS_PER_FORM = 2.0


@dataclass(frozen=True)
class Suspect:
    """A class of forms: place, class text, and the nats that it gains less what its number of forms costs."""

    place: str
    class_text: str
    gain: float


def suspects(detection: Detection) -> list[Suspect]:
    """Classes of forms, best first: each by the joint gain of its forms."""
    groups: dict[tuple[str, str], list[int]] = {}
    for index, form in enumerate(detection.forms):
        groups.setdefault((form.place, form.class_text), []).append(index)
    found = []
    for (place, text), members in groups.items():
        gain = joint_gain(detection.scores, members)
        worst = max(1.0, *(2.0 * detection.null_gain[index] for index in members))
        found.append(Suspect(place, text, gain / worst - NATS_PER_FORM * len(members)))
    return sorted(found, key=lambda suspect: -suspect.gain)


def joint_gain(scores: Scores, members: Sequence[int]) -> float:
    """What all forms of a class together take away, to first order."""
    norm = np.diag(scores.gram)
    chosen = [i for i in members if norm[i] > LEAST_LEFT * max(scores.raw[i], 1e-12)]
    if not chosen:
        return 0.0
    unit = 1.0 / np.sqrt(norm[chosen])
    gram = scores.gram[np.ix_(chosen, chosen)] * np.outer(unit, unit)
    score = scores.score[chosen] * unit
    return 0.5 * float(score @ np.linalg.solve(gram + RIDGE * np.eye(len(chosen)), score))


__all__ = ["Form", "Suspect", "joint_gain", "suspects"]
