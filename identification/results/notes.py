"""What is to be told of a fit besides its numbers, a sentence each: what it cannot tell, what contradicts what, what no sensor does."""

from collections.abc import Mapping, Sequence

from identification.results.held import Leaning
from identification.stages.estimate import Data, Estimate
from identification.uncertainty.identifiability import Direction
from identification.uncertainty.residuals import ResidualTest
from records.text.uncertain import to_sd
from records.text.units import unit_of

LEAST_CHANCE = 1e-300
MOST_DIRECTIONS = 3
MOST_HELD = 4


def stage_notes(data: Data, stage: Estimate, units: Mapping[str, str]) -> tuple[str, ...]:
    """What one stage cannot tell, by direction; what contradicts earlier data, by parameter, in its unit; residuals that are no sensor's
    errors.
    """
    blind = [f"{data}: {_direction(entry)}" for entry in stage.unseen[:MOST_DIRECTIONS]]
    if len(stage.unseen) > MOST_DIRECTIONS:
        blind.append(f"{data}: {len(stage.unseen) - MOST_DIRECTIONS} more such directions, in identification.json")
    pulled = [
        f"{data}: contradicts earlier data in {entry.name}: "
        f"{_apart(entry.before, 'before', entry.after, 'now', entry.sds, units.get(entry.name, ''))}"
        for entry in stage.contradictions[:3]
    ]
    against = [
        f"{data}: {entry.run} contradicts {entry.against} in {entry.name}: "
        f"{_apart(entry.own, 'by itself', entry.others, f'by {entry.against}', entry.sds, units.get(entry.name, ''))}"
        for entry in stage.discords[:3]
    ]
    coloured = [
        f"{test.run if test.run in data.logs else data}: residuals of {test.channel} are correlated "
        f"({chance(test.whiteness_p)}, rms {_in_its_unit(test)}); its samples count for fewer"
        for test in stage.residuals
        if not test.white
    ]
    bound = [
        f"{data}: {name} ended at its bound; the data pull it further: widen --bounds, or doubt the model"
        for name in stage.at_bound
    ]
    return (*blind, *bound, *pulled, *against, *coloured)


def _apart(one: float, whose: str, other: float, others: str, sds: float, unit: str) -> str:
    """Two values that are so many sd of their difference apart, and what to do."""
    sd = abs(one - other) / sds
    return (
        f"{to_sd(one, sd)} {whose}, {f'{to_sd(other, sd)} {unit}'.rstrip()} {others}, {sds:.0f} sd apart; "
        "find out what differs, or leave one of them out"
    )


def _times(factor: float) -> str:
    return f"{factor:.2g}" if factor < 9.95 else f"{factor:.0f}"


def _in_its_unit(test: ResidualTest) -> str:
    return f"{test.rms:.2g} {unit_of(test.channel)}".rstrip()


def bound_warning(names: Sequence[str]) -> str:
    """That these coefficients ended at a bound of their range, where there are any."""
    if not names:
        return ""
    verb = "ended at its bound" if len(names) == 1 else "ended at their bounds"
    return f"{', '.join(names)} {verb}: no estimates; doubt the columns, the model or --bounds"


def leaning_notes(title: str, found: Sequence[Leaning]) -> tuple[str, ...]:
    """One sentence, of the parameter that what was held may move farthest beyond its stated sd."""
    if not found:
        return ()
    worst = max(found, key=lambda entry: entry.by / entry.sd)
    named = ", ".join(worst.held[:MOST_HELD]) + (
        f" and {len(worst.held) - MOST_HELD} more" if len(worst.held) > MOST_HELD else ""
    )
    return (
        f"{title}: the intervals take {named or 'what was held'} as exact; by the sd in the plant file {worst.name} may be off by "
        f"{worst.by:.2g} {worst.unit}, {_times(worst.by / worst.sd)} times the sd stated: "
        "free them too (--free), or count what the file knows (--prior)",
    )


def chance(p: float) -> str:
    """A small probability as text; what a float64 cannot hold is not 0."""
    return f"p = {p:.1g}" if p > LEAST_CHANCE else f"p < {LEAST_CHANCE:.0e}"


def _direction(entry: Direction) -> str:
    parts = " ".join(f"{weight:+.2f} {name}" for name, weight in entry.weights)
    return (
        f"not identifiable alone: the direction {parts}, each relative to its size (sd {relative(entry.relative_sd)})"
    )


def relative(sd: float) -> str:
    """A relative sd in per cent without an exponent."""
    percent = 100.0 * sd
    return f"{percent:.2g} %" if percent < 99.5 else f"{percent:.0f} %" if percent < 1000.0 else "> 1000 %"
