"""The whole chain of seed 003: for each flight condition open loop, closed loop, starts, output equation; then interpolation."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.envelope.check import Check
from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import Flight
from identification.envelope.flights.shortcomings import unused
from identification.envelope.flights.starts import NONE, Starts
from identification.envelope.interpolation import between, nearest, neighbours
from identification.envelope.one_condition import (
    ConditionResult,
    Interpolated,
    Order,
    OrderBetween,
    identified,
    interpolated,
)
from jobs.plain import typed
from records.errors import BadInput

Array = NDArray[np.float64]
Each = Callable[[Callable[[Any], Any], Sequence[Any]], Iterable[Any]]


@dataclass(frozen=True, eq=False)
class Study:
    """All conditions, those left out, the number of flights, and which of them served nothing."""

    conditions: tuple[ConditionResult, ...]
    left_out: tuple[Interpolated, ...]
    flights: int
    unused: tuple[str, ...] = ()

    @property
    def checks(self) -> tuple[Check, ...]:
        """All free runs: identification and validation by condition, then those of conditions left out."""
        own = (check for entry in self.conditions for check in entry.checks)
        return (*own, *(entry.between for entry in self.left_out))


def _unsaved(_: Study) -> None:
    pass


def study(
    flights: Sequence[Flight],
    forgetting: float = 1.0,
    each: Each = map,
    save: Callable[[Study], None] = _unsaved,
    starts: Starts = NONE,
) -> Study:
    """Identify every condition that has flights for it, then interpolate where others are given; `each` does the orders as `map` does.

    `starts` are those typed in by hand. `save` is told what is known after each, so that an interrupted study leaves what it has.
    Raises BadInput for flights that cannot be joined or have different sample periods, and for a condition left out without
    neighbours on both sides.
    """
    found, left_out = list[ConditionResult](), list[Interpolated]()

    def so_far() -> Study:
        return Study(tuple(found), tuple(left_out), len(flights), unused(flights))

    _one_period(flights)
    known, unknown = _conditions(flights, "identification"), _conditions(flights, "interpolation")
    for condition in unknown:
        neighbours(known, condition)
    orders = [Order(at, _of(flights, at), forgetting, dict(starts)) for at in known]
    for answer in each(identified, orders):
        found.append(typed(ConditionResult, answer))
        save(so_far())
    models = {entry.condition: entry.model for entry in found}
    tries = [
        OrderBetween(at, _of(flights, at, "interpolation"), between(models, at), nearest(models, at), dict(starts))
        for at in unknown
    ]
    for answer in each(interpolated, tries):
        left_out.append(typed(Interpolated, answer))
        save(so_far())
    return so_far()


def _one_period(flights: Sequence[Flight]) -> None:
    """Raises BadInput where a model of one sample period would have to predict flights of another."""
    by_period = {flight.sample_period_s: flight.name for flight in flights}
    if len(by_period) > 1:
        got = " and ".join(f"{period_s:g} s ({name})" for period_s, name in sorted(by_period.items()))
        raise BadInput("sample_period_s", "flights", got, "one for all flights", "resample the others")


def _of(flights: Iterable[Flight], condition: Condition, use: str | None = None) -> tuple[Flight, ...]:
    return tuple(entry for entry in flights if entry.condition == condition and use in (None, entry.use))


def _conditions(flights: Iterable[Flight], use: str) -> list[Condition]:
    return sorted({flight.condition for flight in flights if flight.use == use})
