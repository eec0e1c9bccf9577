"""Sentences that go with a diagnosis: which parameters moved, what looks alike and why, what these data could not have shown."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.case import Case
from diagnosis.fit import Fit, Free, away, size_scale
from diagnosis.hypothesis import coefficients
from diagnosis.screen import Look
from diagnosis.search import Tried
from diagnosis.weigh import Weighed, alike

FAR = 3.0  # standard deviations beyond which a parameter is worth a sentence
SEEN = 4.0  # score that an effect needs to be seen
IMITATED = 0.995
BLIND = 0.6  # share of the library unseen at its reference sizes with which data cannot tell


def notes_of(case: Case, looks: Sequence[Look], chosen: Tried, weighed: Weighed | None) -> tuple[str, ...]:
    """All sentences."""
    return (*_moved(case, chosen), *_twins(case, weighed), *_imitated(looks, chosen), *_unseen(case, looks, chosen))


def cannot_tell(looks: Sequence[Look]) -> bool:
    """Whether most of the library would go unseen in these data even at its reference sizes."""
    return bool(looks) and float(np.mean([entry.power < SEEN for entry in looks])) > BLIND


def moved_parameters(case: Case, theta: np.ndarray, far: float = FAR) -> list[int]:
    """Free coefficients (indices into theta) further than `far` from what is stated, the furthest first."""
    return [index for index in np.argsort(-np.abs(theta)).tolist() if abs(theta[index]) > far]


def moved_effects(fit: Fit, far: float = FAR) -> list[Free]:
    """Numbers of effects that the plant file states, further than `far` from there."""
    numbers = [entry for entry in fit.free if entry.stated is not None]
    distances = away(fit.supposed, fit.free)[len(fit.supposed.theta) :]
    return [entry for entry, distance in zip(numbers, distances.tolist(), strict=True) if abs(distance) > far]


def _moved(case: Case, chosen: Tried) -> Iterator[str]:
    names = [str(symbol) for symbol in case.kit.bound.model.parameter_symbols]
    theta = chosen.fit.supposed.theta
    p = coefficients(case, case.kit.plain, chosen.fit.supposed.with_effects({}))  # what cannot be negative is not
    for index in moved_parameters(case, theta):
        place = int(case.free[index])
        yield (
            f"parameter {names[place]} is {theta[index]:+.1f} standard deviations from its stated value: "
            f"{p[place]:.4g} instead of {case.kit.bound.p[place]:.4g}"
        )
    for entry in moved_effects(chosen.fit):
        symbol, stated = entry.parameter.symbol, entry.stated or 0.0
        sd = case.stated_sd[entry.effect][symbol]
        value = chosen.fit.supposed.effects[entry.effect][symbol]
        yield (
            f"{symbol} of {entry.effect} is {(value - stated) / sd:+.1f} standard deviations from its stated value: "
            f"{value:.4g} instead of {stated:.4g}"
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


def _imitated(looks: Sequence[Look], chosen: Tried) -> Iterator[str]:
    hidden = sorted(entry.effect for entry in looks if entry.absorbed > IMITATED and entry.effect not in chosen.effects)
    if hidden:
        yield f"a re-tune of the plant's own parameters imitates these, so these data cannot tell them: {', '.join(hidden)}"


def _unseen(case: Case, looks: Sequence[Look], chosen: Tried) -> Iterator[str]:
    """How large effects could be without being seen."""
    found = []
    for entry in sorted(looks, key=lambda entry: entry.effect):
        size = case.kit.effects[entry.effect].size
        away = size_scale(size) * SEEN / max(entry.power, 1e-9)
        if entry.power < SEEN and entry.absorbed <= IMITATED and away < size.upper - size.lower:
            found.append(f"{entry.effect} up to {size.symbol} = {(size.zero or 0.0) + away:.3g} {size.unit}")
    if found:
        yield f"too little excitation to see these below the sizes given: {'; '.join(found)}"
