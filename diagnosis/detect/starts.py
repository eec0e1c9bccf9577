"""Where the fit of an effect may begin, and what it promises there."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product

from diagnosis import decisions
from sim.effect import Effect, Values

MOST_STARTS = 8  # of an effect's shapes that are scored: time


@dataclass(frozen=True)
class Start:
    """Values from where a fit may begin, and the logs, by number, that deny the effect."""

    values: Values
    denied: frozenset[int] = frozenset()


@dataclass(frozen=True, eq=False)
class ScoreTest:
    """An effect with values to start a fit from: `z` its efficient score in standard deviations, `gain` of the log likelihood to first
    order, `absorbed` the share of its signature that the plant's coefficients imitate, `power` the score that its reference size
    would have. `denied` are the numbers of logs that show nothing of it where others do, `others` further starts that promise nearly
    as much, from which a fit may end on another hill."""

    effect: str
    values: Values
    z: float
    gain: float
    absorbed: float
    power: float
    denied: frozenset[int] = frozenset()
    others: tuple[Start, ...] = ()

    @property
    def starts(self) -> tuple[Start, ...]:
        """All from where its fit may begin, the most promising first."""
        return (Start(self.values, self.denied), *self.others)


def shape_starts(effect: Effect) -> list[dict[str, float]]:
    """Values of an effect's shapes to start from, its sizes left out."""
    shapes = [parameter for parameter in effect.parameters if not parameter.is_size]
    choices = [p.starts or (p.reference,) for p in shapes]
    return [dict(zip((p.symbol for p in shapes), chosen, strict=True)) for chosen in product(*choices)][:MOST_STARTS]


def each_best(found: Iterable[ScoreTest]) -> list[ScoreTest]:
    """Of each effect the best, with further starts."""
    by_effect: dict[str, list[ScoreTest]] = {}
    for entry in found:
        by_effect.setdefault(entry.effect, []).append(entry)
    return [_best(entries) for entries in by_effect.values()]


def _best(found: Iterable[ScoreTest]) -> ScoreTest:
    """The best of one effect's, with the others that promise enough: by first order nobody knows which shape's hill is the highest."""
    best, *others = sorted(found, key=lambda entry: -entry.gain)
    least = max(decisions.PROMISED_SHARE * best.gain, float(decisions.TAKEN_IN))
    return replace(
        best, others=tuple(Start(o.values, o.denied) for o in others[: decisions.NEXT - 1] if o.gain > least)
    )
