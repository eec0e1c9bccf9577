"""What an effect outside the library looks like: where it acts and on what it depends, by which forms explain the gap best."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.form_scores import MEAN_GAIN, FormScores, gains
from records.text.functional_class import parse_class
from sim.effect import Effect

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Suspect:
    """A class of forms: place, class text, and the nats that it gains less what its number of forms costs."""

    place: str
    class_text: str
    gain: float


def suspects(by_form: FormScores) -> list[Suspect]:
    """Classes of forms, best first: each by the joint gain of the forms that it takes one after another."""
    groups: dict[tuple[str, str], list[int]] = {}
    for index, form in enumerate(by_form.forms):
        groups.setdefault((form.place, form.class_text), []).append(index)
    found = [Suspect(place, text, class_gain(by_form, members)) for (place, text), members in groups.items()]
    return sorted(found, key=lambda suspect: -suspect.gain)


def left_beside(by_form: FormScores, effects: Sequence[Effect]) -> float:
    """Nats that the best class of forms still gains beside effects; what acts where they do is rather their own form, a little other."""
    own = {_side(effect.place) for effect in effects}
    limited = {_side(effect.place) for effect in effects if effect.is_limit}

    def weight(place: str, text: str) -> float:
        if parse_class(text).kind == "limit" and _side(place) in limited:
            return decisions.NEGLIGIBLE_SHARE
        return decisions.SAME_PLACE if _side(place) in own else 1.0

    usual = np.maximum(1.0, by_form.null_gain / MEAN_GAIN)
    alone = gains(by_form.scores) / usual
    found = [suspect.gain * weight(suspect.place, suspect.class_text) for suspect in suspects(by_form)]
    found += [float(g) * weight(form.place, form.class_text) for form, g in zip(by_form.forms, alone, strict=True)]
    return max(found, default=0.0)


def _side(place: str) -> str:
    """A rotor and its input as one."""
    return place.removesuffix("_rotor").removesuffix("_input")


def class_gain(by_form: FormScores, members: Sequence[int]) -> float:
    """What the forms of a class take away: the best, then what the best of the others adds to it, each less the cost of choosing it."""
    scores = by_form.scores
    norm = np.diag(scores.gram)
    chosen = [i for i in members if norm[i] > decisions.LEAST_LEFT_SHARE * max(scores.raw[i], 1e-12)]
    unit = 1.0 / np.sqrt(norm[chosen])
    gram = scores.gram[np.ix_(chosen, chosen)] * np.outer(unit, unit)
    score = scores.score[chosen] * unit
    usual = np.maximum(1.0, by_form.null_gain[chosen] / MEAN_GAIN)
    cost, total = decisions.SHAPE_COST + float(np.log(len(members))), 0.0
    for _ in range(min(decisions.NEXT, len(chosen))):
        left = np.diag(gram)
        gains = np.where(left > decisions.LEAST_LEFT_SHARE, 0.5 * score**2 / np.maximum(left, 1e-12), 0.0) / usual
        best = int(np.argmax(gains))
        if gains[best] < cost:
            break
        total += float(gains[best]) - cost
        share = gram[:, best] / gram[best, best]
        score = score - share * score[best]
        gram = gram - np.outer(share, gram[best])
    return total
