"""A diagnosis' material: the plant's library and its logs as filter inputs, with where each starts."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.filter_input import FilterInput, beginning, filter_input_of
from diagnosis.hypothesis.held_axes import with_held
from diagnosis.hypothesis.initial_state import start_of
from diagnosis.library.effect_library import EffectLibrary
from records.log import RunLog
from sim.bind import BoundPlant
from sim.effect import Values

Array = NDArray[np.float64]
BEGINNING_ROWS = 2500  # time: the few numbers of noise are known to some per cent from those
LEAST_VARIANCE = 1e-6  # of any combination of the coefficients, in squares of their stated deviations


@dataclass(frozen=True, eq=False)
class FilteredLog:
    """One log as the filter takes it: its number among all, filter input, start x0 and its variances p0 (states,), axes held; `drive`
    (states,) as in FilterNoise."""

    number: int
    log: RunLog
    filter_input: FilterInput
    x0: Array
    p0: Array
    locked: tuple[str, ...]
    drive: Array

    @cached_property
    def step_s(self) -> float:
        """The usual step from row to row."""
        return float(np.median(np.diff(self.log.t_s)))

    @cached_property
    def first_read(self) -> tuple[float, ...]:
        """The first reading of each of the log's outputs; 0 of one that was never measured."""
        return tuple(float(seen[0]) if (seen := column[np.isfinite(column)]).size else 0.0 for column in self.log.y.T)


@dataclass(frozen=True, eq=False)
class Case:
    """All flights of one plant, and the slot that each output's innovations take (-1: never measured).

    `stated` are effects that the plant file itself states, by symbol, with `stated_sd`: every hypothesis supposes them. `draws` are those
    that each run shows otherwise, which none does: the noise fitted to these logs stands for them. `spread`
    (free, free) is a root S of the correlation C = S S' that it states of its coefficients, None where they are independent.
    """

    library: EffectLibrary
    flights: tuple[FilteredLog, ...]
    slots: tuple[int, ...]
    free: NDArray[np.int64]
    stated: Mapping[str, Values] = field(default_factory=dict)
    stated_sd: Mapping[str, Values] = field(default_factory=dict)
    draws: Mapping[str, Values] = field(default_factory=dict)
    spread: Array | None = None

    def added(self, effects: Iterable[str]) -> tuple[str, ...]:
        """Those of `effects` that the plant file does not state; noise is none."""
        known = self.library.effects
        return tuple(name for name in effects if name not in self.stated and not known[name].is_noise)

    @cached_property
    def known(self) -> Array:
        """What the plant file says of theta, as information (free, free): the inverse of its correlation."""
        if self.spread is None:
            return np.eye(len(self.free))
        root = np.linalg.inv(self.spread)
        return np.asarray(root.T @ root)

    def pull_of(self, theta: Array) -> Array:
        """Where what is stated pulls theta (free,): the slope of its squared distance, halved."""
        return theta if self.spread is None else np.asarray(self.known @ theta)

    @property
    def second_s(self) -> float:
        """How long the plant takes for what others do in a second (sim/equations/pace.py)."""
        return self.library.bound.model.second_s

    @property
    def sd(self) -> Array:
        """Standard deviations of the plant's coefficients that are not known exactly, in the order of `free`."""
        return np.asarray(self.library.bound.sd[self.free])

    @property
    def begins_s(self) -> float:
        """When the earliest of the logs begins, by its clock: what warms up does so from there, and forms in time count from there."""
        return min(float(flight.log.t_s[0]) for flight in self.flights)

    @property
    def nonnegative(self) -> list[int]:
        """Places in p of uncertain coefficients that have a sign to keep."""
        signs = [spec.sign for spec in self.library.bound.model.parameters for _ in range(spec.count)]
        return [int(place) for place in self.free if signs[place] != "any"]

    @cached_property
    def measured_sizes(self) -> Mapping[str, float]:
        """The plant's own states that some log reads, but for what moves as an axis does, and the standard deviation of their readings:
        rotor speeds, currents, temperatures."""
        model, library = self.library.bound.model, self.library
        read = {
            str(model.outputs[name]) if name in model.outputs else name: place
            for place, name in enumerate(library.outputs)
        }
        found = dict[str, float]()
        for state in library.states:
            if state in read and state not in model.axis_states:
                y = np.concatenate([flight.filter_input.y[:, read[state]] for flight in self.flights])
                size = float(np.nanstd(y)) if np.isfinite(y).any() else 0.0
                found |= {state: size} if size > 0.0 else {}
        return found

    def with_flights(self, flights: Sequence[FilteredLog]) -> "Case":
        """The same plant with other flights."""
        return replace(self, flights=tuple(flights))


def make_case(
    library: EffectLibrary,
    logs: Sequence[RunLog],
    used: Sequence[NDArray[np.bool_] | None] | None = None,
    stated: BoundPlant | None = None,
    first: int = 0,
) -> Case:
    """The logs ready for the filter; rows not `used` count as not measured. `stated` is the plant whose effects are stated, `first` the
    number of the first log."""
    masks = used or [None] * len(logs)
    flights = tuple(
        _flight(library, number, log, mask) for number, (log, mask) in enumerate(zip(logs, masks, strict=True), first)
    )
    seen = np.any([np.isfinite(flight.filter_input.y).any(axis=0) for flight in flights], axis=0)
    slots = tuple(int(np.sum(seen[:place])) if seen[place] else -1 for place in range(len(seen)))
    entries = {} if stated is None else stated.effects
    values = {name: {symbol: entry.values[0] for symbol, entry in own.items()} for name, own in entries.items()}
    sd = {name: {symbol: entry.sds[0] for symbol, entry in own.items()} for name, own in entries.items()}
    draws = {name: values.pop(name) for name in list(values) if not library.effects[name].repeats}
    free = np.flatnonzero(library.bound.sd > 0.0)
    return Case(library, flights, slots, free, values, sd, draws, _spread(library.bound, free))


def beginning_of(case: Case) -> Case:
    """The first BEGINNING_ROWS rows of each log: some numbers of noise are known well enough from those."""
    return first_rows(case, BEGINNING_ROWS)


def first_rows(case: Case, count: int) -> Case:
    """The first `count` rows of each log; the case itself where none has more."""
    if all(len(flight.log.t_s) <= count for flight in case.flights):
        return case
    flights = []
    for flight in case.flights:
        since = flight.log.t_s[:count]
        cut = beginning(flight.filter_input, float(since[-1] - since[0]))
        flights.append(flight if len(since) == len(flight.log.t_s) else replace(flight, filter_input=cut))
    return case.with_flights(flights)


def _spread(bound: BoundPlant, free: NDArray[np.int64]) -> Array | None:
    """A root of the stated correlation; what is stated as impossible is taken for nearly so."""
    if bound.plant.correlation is None:
        return None
    names = [str(symbol) for symbol in bound.model.parameter_symbols]
    values, vectors = np.linalg.eigh(bound.plant.correlation.spread_over(tuple(names[place] for place in free)))
    return np.asarray(vectors * np.sqrt(np.maximum(values, LEAST_VARIANCE)))


def _flight(library: EffectLibrary, number: int, log: RunLog, used: NDArray[np.bool_] | None) -> FilteredLog:
    filter_input = filter_input_of(log, library.bound.plant, library.outputs, used)
    filter_input, x0, p0 = with_held(library, filter_input, *start_of(library, filter_input, log.locked), log.locked)
    counted = _found_its_state(filter_input, library.bound.model.second_s)
    return FilteredLog(number, log, counted, x0, p0, log.locked, _drive(library, filter_input))


def _drive(library: EffectLibrary, filter_input: FilterInput) -> Array:
    """What an unknown command, as far from the last as commands are from row to row, does to the state that it drives."""
    model = library.bound.model
    found = np.zeros(len(library.states))
    for rotor in model.places.rotors.values():
        if rotor.drive is None or str(rotor.speed) not in library.states:
            continue
        gain = library.bound.number(sympy.diff(rotor.drive, rotor.variable))
        moves = np.diff(filter_input.u[:, model.inputs.index(rotor.variable)])
        found[library.states.index(str(rotor.speed))] = gain**2 * float(np.mean(moves**2)) if moves.size else 0.0
    return found


def told_from_s(t_s: Array, second_s: float) -> float:
    """From when on readings of a log count, in s; `t_s` (n,) are its instants, `second_s` as of the case."""
    return float(t_s[0] + min(decisions.UNTOLD_S * second_s, decisions.UNTOLD_SHARE * (t_s[-1] - t_s[0])))


def _found_its_state(filter_input: FilterInput, second_s: float) -> FilterInput:
    """The filter input whose first readings do not count: until the filter knows the speeds, its innovations tell of its own start."""
    untold = filter_input.t_s < told_from_s(filter_input.t_s, second_s)
    place, usual = filter_input.place.copy(), filter_input.usual.copy()
    place[untold], usual[untold] = -1, 0.0
    return replace(filter_input, place=place, usual=usual)
