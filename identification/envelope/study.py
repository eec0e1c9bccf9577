"""The whole chain of seed 003: for each flight condition open loop, closed loop, starts, output equation; then interpolation."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.closed_loop import Training, optimise
from identification.envelope.conditions import Condition
from identification.envelope.criteria import Match, flights_passed, matches
from identification.envelope.flight import OUTPUTS, STATES, Deviations, Flight, joined, one_by_one
from identification.envelope.free_run import Model, model_of, one_step
from identification.envelope.fuzzy import Trained
from identification.envelope.initial_state import Tuned, as_measured, automatic, by_hand, over_grid
from identification.envelope.interpolation import GlobalModel, between, nearest, neighbours
from identification.envelope.outputs import Equation, Linear, equations
from identification.envelope.recursive import best, history, pairs
from identification.envelope.shortcomings import poor, unused
from identification.envelope.starts import NONE, Starts
from identification.margins import MARGINS
from records.errors import BadInput

Array = NDArray[np.float64]
FINAL = "with trim"  # whose states the output equation of the global model takes


@dataclass(frozen=True, eq=False)
class Check:
    """A model tried on flights of one mission: its states by tuning and its accelerations by method, and how both match.

    `start` (flights, 8) are the tuned starts as whole signals, by tuning; "by hand" is among the tunings where any were typed in.
    `open_loop` is one step ahead, `open_loop_whole` the same with the trim put back, which flatters Theil's fit; `outputs` come from
    measured states (chapter 3), `overall` from the run's own (chapter 4). `held` counts the flights whose states all stay within their
    margins for three seconds, by tuning.
    """

    name: str
    mission: str
    data: Deviations
    start: Mapping[str, Array]
    x: Mapping[str, Array]
    y: Mapping[str, Array]
    y_overall: Mapping[str, Array]
    open_loop: tuple[Match, ...]
    open_loop_whole: tuple[Match, ...]
    held: Mapping[str, int]
    states: Mapping[str, tuple[Match, ...]]
    outputs: Mapping[str, tuple[Match, ...]]
    overall: Mapping[str, tuple[Match, ...]]


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
class Study:
    """All conditions, those left out, the number of flights, and which of them served nothing."""

    conditions: tuple[ConditionResult, ...]
    left_out: tuple[Interpolated, ...]
    flights: int
    unused: tuple[str, ...] = ()

    def at(self, name: str) -> ConditionResult:
        """The condition of a name, or the first where there is none of it."""
        return next((entry for entry in self.conditions if entry.condition.name == name), self.conditions[0])


def _silent(_: str) -> AbstractContextManager[None]:
    return nullcontext()


def _unsaved(_: Study) -> None:
    pass


def study(
    flights: Sequence[Flight],
    forgetting: float = 1.0,
    stage: Callable[[str], AbstractContextManager[None]] = _silent,
    save: Callable[[Study], None] = _unsaved,
    starts: Starts = NONE,
) -> Study:
    """Identify every condition that has flights for it, then interpolate where others are given; `stage` is entered for each.

    `starts` are those typed in by hand. `save` is told what is known after each, so that an interrupted study leaves what it has.
    Raises BadInput for flights that cannot be joined or have different sample periods, and for a condition left out without
    neighbours on both sides.
    """
    found, left_out = list[ConditionResult](), list[Interpolated]()

    def so_far() -> Study:
        return Study(tuple(found), tuple(left_out), len(flights), unused(flights))

    _one_period(flights)
    known = _conditions(flights, "identification")
    for condition in _conditions(flights, "interpolation"):
        neighbours(known, condition)
    for condition in known:
        with stage(condition.name):
            mine = [entry for entry in flights if entry.condition == condition]
            found.append(identify(condition, mine, forgetting, starts))
        save(so_far())
    models = {entry.condition: entry.model for entry in found}
    for condition in _conditions(flights, "interpolation"):
        with stage(f"{condition.name}, left out"):
            mine = [entry for entry in flights if entry.condition == condition and entry.use == "interpolation"]
            left_out.append(_interpolated(condition, models, mine, starts))
        save(so_far())
    return so_far()


def _one_period(flights: Sequence[Flight]) -> None:
    """Raises BadInput where a model of one sample period would have to predict flights of another."""
    by_period = {flight.sample_period_s: flight.name for flight in flights}
    if len(by_period) > 1:
        got = " and ".join(f"{period_s:g} s ({name})" for period_s, name in sorted(by_period.items()))
        raise BadInput("sample_period_s", "flights", got, "one for all flights", "resample the others")


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


def margins_of(mission: str) -> tuple[Array, Array]:
    """Margins of the states (8,) and of the accelerations (3,) for a mission."""
    return np.array([MARGINS[mission][name] for name in STATES]), np.array([MARGINS[mission][name] for name in OUTPUTS])


def check(
    name: str,
    mission: str,
    data: Deviations,
    open_loop: Model,
    model: Model,
    ways: Mapping[str, Equation],
    starts: Starts = NONE,
) -> Check:
    """Try `open_loop` one step ahead and `model` in free runs, tuned flight by flight."""
    margins_x, margins_y = margins_of(mission)
    period_s = data.sample_period_s
    tuned = _tuned(model, data, margins_x, starts)
    x = {how: np.stack([flight.x for flight in flights]) for how, flights in tuned.items()}
    y = {way: equation(data, data.x) for way, equation in ways.items()}
    y_overall = {way: equation(data, x[FINAL]) for way, equation in ways.items()}
    ahead, trim = one_step(open_loop, data), data.trim[:, None, 4:12]
    start = {how: np.stack([flight.start for flight in flights]) + trim[:, 0] for how, flights in tuned.items()}
    return Check(
        name, mission, data, start, x, y, y_overall,
        matches(STATES, data.x, ahead, margins_x, period_s),
        matches(STATES, data.x + trim, ahead + trim, margins_x, period_s),
        {how: flights_passed(data.x, run, margins_x, period_s) for how, run in x.items()},
        {how: matches(STATES, data.x, run, margins_x, period_s) for how, run in x.items()},
        {way: matches(OUTPUTS, data.y, guess, margins_y, period_s) for way, guess in y.items()},
        {way: matches(OUTPUTS, data.y, guess, margins_y, period_s) for way, guess in y_overall.items()},
    )  # fmt: skip


def _tuned(model: Model, data: Deviations, margins: Array, starts: Starts) -> Mapping[str, Sequence[Tuned]]:
    """The free run of each flight, by tuning; by hand only where starts were typed in, and then the other flights start as measured."""
    ways: dict[str, Callable[[Deviations], Tuned]] = {
        "measured": lambda flight: as_measured(model, flight),
        "by hand": lambda flight: by_hand(model, flight, starts.get(flight.names[0], {})),
        "grid": lambda flight: over_grid(model, flight, margins),
        "automatic": lambda flight: automatic(model, flight, margins),
        FINAL: lambda flight: automatic(model, flight, margins, trim=True),
    }
    if not starts:
        del ways["by hand"]
    return {how: [tune(flight) for flight in one_by_one(data)] for how, tune in ways.items()}


def _interpolated(
    condition: Condition, models: Mapping[Condition, GlobalModel], flights: Sequence[Flight], starts: Starts
) -> Interpolated:
    data, mission = joined(flights), flights[0].mission

    def tried(model: GlobalModel) -> Check:
        return check(condition.name, mission, data, model.state, model.state, {"linear": model.output}, starts)

    model = between(models, condition)
    return Interpolated(condition, model, tried(model), tried(nearest(models, condition)))
