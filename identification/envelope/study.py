"""The whole chain of seed 003: for each flight condition open loop, closed loop, starts, output equation; then interpolation."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.envelope.check import Check, check, margins_of
from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import Flight, joined
from identification.envelope.flights.shortcomings import poor, unused
from identification.envelope.flights.starts import NONE, Starts
from identification.envelope.interpolation import GlobalModel, between, nearest, neighbours
from identification.envelope.output_equation.fuzzy import Trained
from identification.envelope.output_equation.outputs import Linear, equations
from identification.envelope.state_equation.closed_loop import Training, optimise
from identification.envelope.state_equation.free_run import Model, model_of
from identification.envelope.state_equation.recursive import best, history, pairs
from jobs.plain import plain, typed
from records.errors import BadInput

Array = NDArray[np.float64]
Each = Callable[[Callable[[Any], Any], Sequence[Any]], Iterable[Any]]


@dataclass(frozen=True, eq=False)
class ConditionResult:
    """One identified condition: `row` of the recursion that was chosen, by potential; checks begin with the identification itself.

    `notes` say what its flights cannot tell.
    """

    condition: Condition
    notes: tuple[str, ...]
    row: int
    potentials: Array
    open_loop: Model
    training: Training
    fuzzy: Trained
    model: GlobalModel
    checks: tuple[Check, ...]


@dataclass(frozen=True, eq=False)
class Interpolated:
    """A condition left out: flights predicted by the model between its neighbours, and by the nearest neighbour's."""

    condition: Condition
    model: GlobalModel
    between: Check
    nearest: Check


@dataclass(frozen=True, eq=False)
class Order:
    """One condition with all that its identification depends on."""

    condition: Condition
    flights: tuple[Flight, ...]
    forgetting: float
    starts: Starts

    @property
    def name(self) -> str:
        """The condition's."""
        return self.condition.name


@dataclass(frozen=True, eq=False)
class OrderBetween:
    """One condition left out, with the two models to be tried on its flights."""

    condition: Condition
    flights: tuple[Flight, ...]
    between: GlobalModel
    nearest: GlobalModel
    starts: Starts

    @property
    def name(self) -> str:
        """The condition's, and that it was left out."""
        return f"{self.condition.name}, left out"


@dataclass(frozen=True, eq=False)
class Study:
    """All conditions, those left out, the number of flights, and which of them served nothing."""

    conditions: tuple[ConditionResult, ...]
    left_out: tuple[Interpolated, ...]
    flights: int
    unused: tuple[str, ...] = ()

    def at(self, name: str) -> ConditionResult:
        """The condition of a name, or the first where there is none of it."""
        return next((entry for entry in self.conditions if entry.condition.name == name), self.conditions[0])


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


def identified(order: Order) -> dict[str, Any]:
    """The plain form of a ConditionResult; raises BadInput as `identify` does."""
    found: dict[str, Any] = plain(identify(order.condition, order.flights, order.forgetting, order.starts))
    return found


def interpolated(order: OrderBetween) -> dict[str, Any]:
    """The plain form of an Interpolated; raises BadInput for flights that cannot be joined."""
    data, mission = joined(order.flights), order.flights[0].mission

    def tried(model: GlobalModel) -> Check:
        return check(
            order.condition.name, mission, data, model.state, model.state, {"linear": model.output}, order.starts
        )

    found: dict[str, Any] = plain(
        Interpolated(order.condition, order.between, tried(order.between), tried(order.nearest))
    )
    return found


def _of(flights: Iterable[Flight], condition: Condition, use: str | None = None) -> tuple[Flight, ...]:
    return tuple(entry for entry in flights if entry.condition == condition and use in (None, entry.use))


def _conditions(flights: Iterable[Flight], use: str) -> list[Condition]:
    return sorted({flight.condition for flight in flights if flight.use == use})


def identify(
    condition: Condition, flights: Sequence[Flight], forgetting: float = 1.0, starts: Starts = NONE
) -> ConditionResult:
    """Chapters 2 to 4 for one condition; raises BadInput for flights that cannot be joined or a factor outside (0, 1]."""
    mine = [flight for flight in flights if flight.use == "identification"]
    data, mission = joined(mine), mine[0].mission
    margins_x, margins_y = margins_of(mission)
    rows = pairs(data)
    estimates = history(rows, forgetting)
    row, potentials = best(estimates, rows, margins_x)
    open_loop = model_of(estimates[row], data.sample_period_s)
    training = optimise(open_loop, data, margins_x)
    ways, trained = equations(data, margins_y)
    assert isinstance(ways["linear"], Linear)
    checks = [check(f"{condition.name} identification", mission, data, open_loop, training.model, ways, starts)]
    for flight in flights:
        if flight.use == "validation":
            alone = joined([flight])
            checks.append(check(flight.name, flight.mission, alone, open_loop, training.model, ways, starts))
    model = GlobalModel(training.model, ways["linear"])
    return ConditionResult(
        condition, poor(mine, data), row, potentials, open_loop, training, trained, model, tuple(checks)
    )
