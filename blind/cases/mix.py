"""Which cases a benchmark holds: shares of kinds, effects dealt round so that each comes up, wanted severities."""

from collections.abc import Sequence
from itertools import cycle, islice

import numpy as np
from numpy.random import Generator

from blind.effects.effect import Catalogue, Effect
from blind.rigs.bench import Plan
from records.errors import BadInput

# Share of each kind and the range of severities that is wanted for each of its effects.
SHARES = {
    "nominal": (0.20, (0.0, 0.0)),
    "single": (0.30, (2.0, 50.0)),
    "small": (0.10, (0.5, 2.0)),
    "double": (0.15, (3.0, 30.0)),
    "triple": (0.05, (4.0, 30.0)),
    "outside": (0.15, (2.0, 50.0)),
    "timing": (0.05, (2.0, 30.0)),
}
KINDS = tuple(SHARES)
EFFECTS_IN = {"nominal": 0, "double": 2, "triple": 3}


def plans(cases: int, kinds: Sequence[str], catalogue: Catalogue, rng: Generator) -> list[Plan]:
    """`cases` plans in random order, kinds by their shares; raises BadInput for an unknown kind or no case."""
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown or not kinds:
        got = repr(unknown[0]) if unknown else "none"
        raise BadInput("kind of case", "--kinds", got, f"some of {', '.join(KINDS)}", "name kinds with commas between")
    if cases < 1:
        raise BadInput("number of cases", "--cases", str(cases), "at least 1", "ask for a positive number")
    dealt = [plan for kind in kinds for plan in _of_kind(kind, _count(kind, kinds, cases), catalogue, rng)]
    order = rng.permutation(len(dealt))
    return [dealt[index] for index in order]


def _count(kind: str, kinds: Sequence[str], cases: int) -> int:
    """Largest remainder: the counts add up to `cases`."""
    whole = sum(SHARES[name][0] for name in kinds)
    exact = {name: cases * SHARES[name][0] / whole for name in kinds}
    counts = {name: int(value + 1e-9) for name, value in exact.items()}
    missing = cases - sum(counts.values())
    for name in sorted(kinds, key=lambda name: counts[name] - exact[name])[:missing]:
        counts[name] += 1
    return counts[kind]


def _of_kind(kind: str, count: int, catalogue: Catalogue, rng: Generator) -> list[Plan]:
    pool = {"outside": catalogue.outside, "timing": catalogue.timing}.get(kind, catalogue.known)
    groups = _groups(pool, EFFECTS_IN.get(kind, 1), count, rng)
    return [_plan(kind, group, index, rng) for index, group in enumerate(groups)]


def _plan(kind: str, group: tuple[Effect, ...], index: int, rng: Generator) -> Plan:
    low, high = SHARES[kind][1]
    targets = tuple(float(np.exp(rng.uniform(np.log(low), np.log(high)))) for _ in group)
    return Plan(kind, group, targets, excited=index % 2 == 0, rotor_speeds=bool(rng.random() < 0.5))


def _groups(pool: Sequence[Effect], size: int, count: int, rng: Generator) -> list[tuple[Effect, ...]]:
    """Groups whose first effects go through the whole shuffled pool before one comes again."""
    firsts = islice(cycle([pool[index] for index in rng.permutation(len(pool))]), count)
    return [_filled(first, pool, size, rng) for first in firsts] if size else [()] * count


def _filled(first: Effect, pool: Sequence[Effect], size: int, rng: Generator) -> tuple[Effect, ...]:
    group = [first]
    while len(group) < size:
        other = pool[int(rng.integers(len(pool)))]
        if all(_fit_together(other, member) for member in group):
            group.append(other)
    return tuple(group)


def _fit_together(a: Effect, b: Effect) -> bool:
    """Two effects of one sensor kind, or of one name, could not be told from each other's change; they are not combined."""
    return a.name != b.name and not (a.sensor and b.sensor)
