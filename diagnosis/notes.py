"""Sentences that go with a diagnosis: which parameters moved, what looks alike and why, what these data could not have shown."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.case import Case
from diagnosis.screen import Look
from diagnosis.search import Tried
from diagnosis.weigh import Weighed, alike

FAR = 2.5  # standard deviations beyond which a parameter is worth a sentence
SEEN = 4.0  # scores at its reference size that an effect needs to be seen


def notes_of(case: Case, looks: Sequence[Look], chosen: Tried, weighed: Weighed | None) -> tuple[str, ...]:
    """All sentences."""
    return (*_moved(case, chosen), *_twins(case, weighed), *_absorbed(looks, chosen))


def _moved(case: Case, chosen: Tried) -> Iterator[str]:
    names = [str(symbol) for symbol in case.kit.bound.model.parameter_symbols]
    theta = chosen.fit.supposed.theta
    for index in np.argsort(-np.abs(theta)).tolist():
        if abs(theta[index]) > FAR:
            place = int(case.free[index])
            value, sd = case.kit.bound.p[place], case.sd[index]
            yield (
                f"parameter {names[place]} is {theta[index]:+.1f} standard deviations from its stated value: "
                f"{value + theta[index] * sd:.4g} instead of {value:.4g}"
            )


def _twins(case: Case, weighed: Weighed | None) -> Iterator[str]:
    if weighed is None or not weighed.tried:
        return
    first = weighed.tried[0]
    for other in alike(weighed, first):
        for name in other.effects:
            for own in first.effects:
                reason = case.kit.effects[own].twins.get(name)
                if reason:
                    yield f"{own} and {name}: {reason}"


def _absorbed(looks: Sequence[Look], chosen: Tried) -> Iterator[str]:
    hidden = sorted(entry.effect for entry in looks if entry.absorbed > 0.995 and entry.effect not in chosen.effects)
    if hidden:
        yield f"a re-tune of the plant's own parameters imitates these within these data, so they cannot be told: {', '.join(hidden)}"
