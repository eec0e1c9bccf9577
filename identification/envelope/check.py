"""A model tried on flights: free runs by tuning of their starts, accelerations by output equation, and how all of it matches."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.criteria import Match, flights_passed, matches
from identification.envelope.flights.flight import OUTPUTS, STATES, Deviations, one_by_one
from identification.envelope.flights.starts import Starts
from identification.envelope.output_equation.outputs import Equation
from identification.envelope.state_equation.free_run import Model, one_step
from identification.envelope.state_equation.initial_state import Tuned, as_measured, automatic, by_hand, over_grid
from identification.margins import MARGINS

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


def margins_of(mission: str) -> tuple[Array, Array]:
    """Margins of the states (8,) and of the accelerations (3,) for a mission."""
    return np.array([MARGINS[mission][name] for name in STATES]), np.array([MARGINS[mission][name] for name in OUTPUTS])


@dataclass(frozen=True, eq=False)
class ToCheck:
    """What is to be checked: `open_loop` one step ahead, `model` in free runs, its accelerations by output equation in several `ways`, and
    starts that were typed in."""

    open_loop: Model
    model: Model
    ways: Mapping[str, Equation]
    starts: Starts


def check(name: str, mission: str, data: Deviations, tried: ToCheck) -> Check:
    """Try a model on flights, tuned flight by flight."""
    margins_x, margins_y = margins_of(mission)
    period_s = data.sample_period_s
    tuned = _tuned(tried.model, data, margins_x, tried.starts)
    x = {how: np.stack([flight.x for flight in flights]) for how, flights in tuned.items()}
    y = {way: equation(data, data.x) for way, equation in tried.ways.items()}
    y_overall = {way: equation(data, x[FINAL]) for way, equation in tried.ways.items()}
    ahead, trim = one_step(tried.open_loop, data), data.trim[:, None, 4:12]
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
