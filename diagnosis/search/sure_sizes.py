"""Whether the size of each effect that was tried is surely not zero: what has none is left out, by a rule that is told."""

from collections.abc import Mapping, Sequence

import numpy as np

from diagnosis import decisions
from diagnosis.decisions import decided
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.linear_problem import Fit
from records.reasons import Decision

TOLD = 4  # hypotheses left out that are told of


def is_certain(fitted: FittedHypothesis, found: Mapping[frozenset[str], FittedHypothesis]) -> bool:
    """Whether every effect has a size that is not zero within its spread, or one that may hardly be zero and without which all is far
    less likely: where an axis sticks, the readings beside it alone make that spread."""
    for name, certainty in certainties(fitted.fit).items():
        without = found.get(frozenset(fitted.effects) - {name})
        missed = 0.0 if without is None else fitted.evidence - without.evidence
        if certainty < decisions.BEYOND_CHANCE and (certainty < decisions.SURELY or missed < decisions.TAKEN_IN):
            return False
    return True


def kept_by_size(
    found: Mapping[frozenset[str], FittedHypothesis], certain: Sequence[FittedHypothesis], best: FittedHypothesis
) -> tuple[Decision, ...]:
    """Of the best, and of all that would be better but for a size that may be zero: how far its least size is from zero."""
    better = [entry for entry in found.values() if entry not in certain and entry.evidence > best.evidence]
    asked = sorted(better, key=lambda entry: -entry.evidence)[:TOLD]
    asked += [best] if best.effects else []
    return tuple(
        decided(
            "size_from_zero",
            " + ".join(entry.effects),
            min(certainties(entry.fit).values(), default=float("nan")),
            decisions.BEYOND_CHANCE,
            "left out: its size may be zero" if certain and entry not in certain else "kept",
        )
        for entry in asked
    )


def certainties(fit: Fit) -> dict[str, float]:
    """How far each effect's size is from zero, in standard deviations; that of one alone with its shapes held where they are.

    Of no size, an effect has no shape: a spring whose rest lies beyond all that was flown may be a little softer and rest further away,
    and is no less there for that. Beside others its shapes may take their part.
    """
    count = len(fit.hypothesis.theta)
    alone = len({entry.effect for entry in fit.free if entry.stated is None}) == 1
    held = [
        row
        for row, entry in enumerate(fit.free, count)
        if alone and entry.stated is None and not entry.parameter.is_size
    ]
    kept = np.setdiff1d(np.arange(len(fit.information)), held)
    spread = np.zeros(len(fit.information))
    spread[kept] = np.sqrt(np.maximum(np.diag(np.linalg.pinv(fit.information[np.ix_(kept, kept)])), 0.0))
    sizes: dict[str, float] = {}
    for entry, sd in zip(fit.free, spread[count:], strict=True):
        if entry.parameter.is_size and entry.stated is None:
            away = fit.hypothesis.effects[entry.effect][entry.parameter.symbol] - (entry.parameter.zero or 0.0)
            certainty = abs(away) / max(float(sd) * entry.scale, 1e-300)
            sizes[entry.effect] = max(sizes.get(entry.effect, 0.0), certainty)
    return sizes
