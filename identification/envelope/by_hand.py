"""What starts that were typed in did to their flights, beside the other tunings (seed 003, Table 2.2)."""

from collections.abc import Mapping
from dataclasses import dataclass

from identification.envelope.check import Check, margins_of
from identification.envelope.criteria import Match, matches
from identification.envelope.flights.flight import STATES
from identification.envelope.flights.starts import Starts
from identification.envelope.study import Study


@dataclass(frozen=True, eq=False)
class Tried:
    """One flight whose start was typed in: by tuning its start by state, as whole signals, and how its eight states match."""

    flight: str
    check: Check
    start: Mapping[str, Mapping[str, float]]
    states: Mapping[str, tuple[Match, ...]]


def tried(found: Study, starts: Starts) -> tuple[Tried, ...]:
    """The flights whose starts were typed in, in the order of the study."""
    return tuple(
        _tried(check, place) for check in found.checks for place, name in enumerate(check.data.names) if name in starts
    )


def _tried(check: Check, place: int) -> Tried:
    margins, data, one = margins_of(check.mission)[0], check.data, slice(place, place + 1)
    return Tried(
        data.names[place],
        check,
        {how: dict(zip(STATES, starts[place].tolist(), strict=True)) for how, starts in check.start.items()},
        {how: matches(STATES, data.x[one], x[one], margins, data.sample_period_s) for how, x in check.x.items()},
    )
