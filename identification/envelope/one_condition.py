"""One flight condition: open loop, closed loop, starts and output equation from its flights; or its flights predicted by neighbours."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.envelope.check import Check, ToCheck, check, margins_of
from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import Flight, joined
from identification.envelope.flights.shortcomings import poor
from identification.envelope.flights.starts import NONE, Starts
from identification.envelope.interpolation import GlobalModel
from identification.envelope.output_equation.fuzzy import Trained
from identification.envelope.output_equation.outputs import Linear, equations
from identification.envelope.state_equation.closed_loop import Training, optimise
from identification.envelope.state_equation.free_run import Model, model_of
from identification.envelope.state_equation.recursive import best, history, pairs
from jobs.plain import plain

Array = NDArray[np.float64]


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


def identified(order: Order) -> dict[str, Any]:
    """The plain form of a ConditionResult; raises BadInput as `identify` does."""
    found: dict[str, Any] = plain(identify(order.condition, order.flights, order.forgetting, order.starts))
    return found


def interpolated(order: OrderBetween) -> dict[str, Any]:
    """The plain form of an Interpolated; raises BadInput for flights that cannot be joined."""
    data, mission = joined(order.flights), order.flights[0].mission

    def checked(model: GlobalModel) -> Check:
        tried = ToCheck(model.state, model.state, {"linear": model.output}, order.starts)
        return check(order.condition.name, mission, data, tried)

    found: dict[str, Any] = plain(
        Interpolated(order.condition, order.between, checked(order.between), checked(order.nearest))
    )
    return found


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
    tried = ToCheck(open_loop, training.model, ways, starts)
    checks = [check(f"{condition.name} identification", mission, data, tried)]
    for flight in flights:
        if flight.use == "validation":
            alone = joined([flight])
            checks.append(check(flight.name, flight.mission, alone, tried))
    model = GlobalModel(training.model, ways["linear"])
    return ConditionResult(
        condition, poor(mine, data), row, potentials, open_loop, training, trained, model, tuple(checks)
    )
