"""What one supposes of a plant: its coefficients, effects with their parameters, and its process noise; and how the logs fit that."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput, variance_stated
from diagnosis.filter.kalman import FilterNoise, Pass, Wanted, slope_of
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.initial_state import FIRST_REST_DOUBT
from diagnosis.library.effect_library import CompiledFilter, EffectLibrary
from diagnosis.library.input_effects import commanded
from diagnosis.library.reading_noise import ReadingNoise, state_of, switch_of, time_of
from diagnosis.library.sensor_effects import sensed
from jobs.thread_map import thread_map
from sim.effect import Effect, Role, Values

Array = NDArray[np.float64]
SHORTEST_LAG_S = 1e-6  # a shorter one is none: to it equations are divided by it
# Noise intensity of states that have none, in any unit next to nothing: without it their variances fade into numbers so small that a
# processor takes a hundred times as long for each.
NEXT_TO_NONE = 1e-40
START_SD = 0.05  # of states that effects brought, in their own units
ELSEWHERE = -1  # instead of a log's number: all logs that have no values of their own


@dataclass(frozen=True)
class Lack:
    """Logs, by number, that are without an effect which others show, and the effect's values of no size; `cost` is what the choice of them
    costs, in nats."""

    logs: frozenset[int]
    absent: Values
    cost: float


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """Steps `theta` (free,) of the plant's uncertain coefficients in standard deviations, `effects` with their values by symbol, and
    `process noise` (axes,): log10 of the noise on each axis' speed per square root of a second.

    `state_noise` is the same of states that are measured and no axis', each in its own unit: a speed that is read cuts the chain there, and
    what drives it is judged apart from what it drives. `rest_doubt` is log10 of how long, in s, dry friction is in doubt where an axis
    comes to rest or leaves it, `reading_noise` the errors of readings that are alike from row to row, by output: noise as the others.
    `own`: what happens at another instant and by another size in each log has values by the log's number, and by ELSEWHERE those of all
    other logs; in `effects` it has those of the first in which it happens. `lacks`: what a rig had in some logs alone, by effect.
    """

    theta: Array
    effects: Mapping[str, Values]
    process_noise: Array
    own: Mapping[str, Mapping[int, Values]] = field(default_factory=dict)
    rest_doubt: float = FIRST_REST_DOUBT
    reading_noise: Mapping[str, ReadingNoise] = field(default_factory=dict)
    state_noise: Mapping[str, float] = field(default_factory=dict)
    lacks: Mapping[str, Lack] = field(default_factory=dict)

    def with_noise_of(self, other: "Hypothesis") -> "Hypothesis":
        """The same with all noise that another supposes."""
        return replace(
            self,
            process_noise=other.process_noise,
            rest_doubt=other.rest_doubt,
            reading_noise=other.reading_noise,
            state_noise=other.state_noise,
        )

    def with_effects(self, effects: Mapping[str, Values]) -> "Hypothesis":
        """The same with other effects."""
        own = {name: values for name, values in self.own.items() if effects.get(name) is self.effects.get(name)}
        lacks = {name: lack for name, lack in self.lacks.items() if name in effects}
        return replace(self, effects=effects, own=own, lacks=lacks)

    def lacking(self, effect: str, lack: Lack | None) -> "Hypothesis":
        """The same with an effect that some logs are without; None: that all have."""
        return self if lack is None else replace(self, lacks={**self.lacks, effect: lack})

    def over(self, flight: FilteredLog) -> "Hypothesis":
        """What it supposes of one log."""
        here = {name: values.get(flight.number, values[ELSEWHERE]) for name, values in self.own.items()}
        here |= {name: lack.absent for name, lack in self.lacks.items() if flight.number in lack.logs}
        return replace(self, effects={**self.effects, **here}, own={}, lacks={}) if here else self

    def value(self, effect: str, symbol: str, log: int | None = None) -> float:
        """A number of an effect, that of one log where it has its own."""
        return (self.effects[effect] if log is None else self.own[effect][log])[symbol]

    def with_value(self, effect: str, symbol: str, value: float, log: int | None = None) -> "Hypothesis":
        """The same with another value of one number."""
        if log is None:
            return self.with_effects({**self.effects, effect: {**self.effects[effect], symbol: value}})
        own = {**self.own[effect], log: {**self.own[effect][log], symbol: value}}
        return self.with_own(effect, own)

    def with_own(self, effect: str, own: Mapping[int, Values]) -> "Hypothesis":
        """The same with values of an effect by log."""
        first = own[min(log for log in own if log != ELSEWHERE)]
        return replace(self, effects={**self.effects, effect: first}, own={**self.own, effect: own})


def noise_on(case: Case, axis: int) -> Effect | None:
    """The effect that is noise with a memory on an axis; None where nothing pushes it."""
    name = case.library.bound.model.axes[axis].name
    return next((e for n in case.library.noises if (e := case.library.effects[n]).place == name), None)


def has_memory(case: Case, hypothesis: Hypothesis) -> bool:
    """Whether it has noise with a memory, of an axis or of readings."""
    return bool(hypothesis.reading_noise) or any(case.library.effects[name].is_noise for name in hypothesis.effects)


def scaled(case: Case, hypothesis: Hypothesis, axis: int, level: float) -> Hypothesis:
    """The same with the process noise of an axis at `level`, and what comes and goes there grown or shrunk as much."""
    process_noise = hypothesis.process_noise.copy()
    by = 10.0 ** (level - process_noise[axis])
    process_noise[axis] = level
    effect = noise_on(case, axis)
    if effect is not None and effect.name in hypothesis.effects:
        values = hypothesis.effects[effect.name]
        size = effect.symbol(Role.STRENGTH)
        hypothesis = hypothesis.with_effects({**hypothesis.effects, effect.name: {**values, size: by * values[size]}})
    return replace(hypothesis, process_noise=process_noise)


def nominal_hypothesis(case: Case, process_noise: float) -> Hypothesis:
    """The plant as stated, with the effects that its file states."""
    axes = len(case.library.bound.model.axes)
    states = first_state_noise(case, process_noise)
    return Hypothesis(np.zeros(len(case.free)), case.stated, np.full(axes, process_noise), state_noise=states)


def first_state_noise(case: Case, level: float) -> dict[str, float]:
    """Noise on measured states as large beside their readings as `level` is beside a speed of 1 rad/s."""
    return {state: level + float(np.log10(size)) for state, size in case.measured_sizes.items()}


def coefficients(case: Case, compiled: CompiledFilter, hypothesis: Hypothesis) -> Array:
    """The vector p of a variant, whose other effects are off; coefficients that cannot be negative stay where they can be."""
    library = case.library
    p = compiled.p.copy()
    p[case.free] = library.bound.p[case.free] + hypothesis.theta * case.sd
    for place in case.nonnegative:
        p[place] = max(p[place], 1e-3 * library.bound.p[place])
    p[list(compiled.switches.values())] = 0.0
    p[[place for name, place in compiled.switches.items() if name in hypothesis.effects]] = 1.0
    for name, values in hypothesis.effects.items():
        if name in compiled.names:
            effect = library.effects[name]
            for symbol, value in {**values, **known_beginning(case, effect)}.items():
                p[compiled.place(name, symbol)] = max(value, SHORTEST_LAG_S) if effect.reads_late else value
    for output in library.bound.model.outputs:
        noise = hypothesis.reading_noise.get(output)
        p[compiled.index[switch_of(output)]] = 0.0 if noise is None else 1.0
        p[compiled.index[time_of(output)]] = 1.0 if noise is None else noise.time_s
    return p


def known_beginning(case: Case, effect: Effect) -> dict[str, float]:
    """When an effect begins, which is known: with the earliest of the logs; nothing for one that has no such number."""
    begins = effect.having(Role.BEGINNING)
    return {} if begins is None else {begins.symbol: case.begins_s}


def filter_input_under(
    case: Case, compiled: CompiledFilter, flight: FilteredLog, hypothesis: Hypothesis
) -> FilterInput:
    """The flight's filter input with what the effects do on the way of the signals, and readings as sure as is supposed."""
    further = {name: values for name, values in hypothesis.effects.items() if name not in compiled.names}
    found = flight.filter_input
    if further:
        found = _sent(case.library, flight, tuple((name, tuple(values.items())) for name, values in further.items()))
    return found if not hypothesis.reading_noise else _as_sure_as_stated(case.library, found, hypothesis)


def _as_sure_as_stated(library: EffectLibrary, filter_input: FilterInput, hypothesis: Hypothesis) -> FilterInput:
    """The filter input with white errors as stated of outputs that have errors alike from row to row: scatter is theirs then."""
    r, single = filter_input.r.copy(), filter_input.single.copy()
    for output in hypothesis.reading_noise:
        place = library.outputs.index(output)
        stated = variance_stated(library.bound.plant, output)
        if 0.0 < stated < single[place]:
            r[:, place] *= stated / single[place]
            single[place] = stated
    return replace(filter_input, r=r, single=single)


@lru_cache(maxsize=32)
def _sent(
    library: EffectLibrary, flight: FilteredLog, effects: tuple[tuple[str, tuple[tuple[str, float], ...]], ...]
) -> FilterInput:
    given = {name: dict(values) for name, values in effects}
    return sensed(library, commanded(library, flight.filter_input, given), given)


def noise_of(case: Case, compiled: CompiledFilter, flight: FilteredLog, hypothesis: Hypothesis) -> FilterNoise:
    """The filter's noise: on each axis' speed its process noise, on effects that are noise their own, next to none elsewhere."""
    x0, p0 = start_under(compiled, flight)
    q = np.full(len(x0), NEXT_TO_NONE)
    q[list(case.library.velocities)] = 10.0 ** (2.0 * hypothesis.process_noise)
    for measured, level in hypothesis.state_noise.items():
        q[compiled.states.index(measured)] = 10.0 ** (2.0 * level)
    forget = np.zeros_like(q)
    for name, values in hypothesis.effects.items():
        state = case.library.effects[name].filter_state
        if state is not None and state.noise is not None:
            place = compiled.states.index(state.name)
            q[place], p0[place] = state.noise(values)
            forget[place] = 0.5 * q[place] / p0[place]
    for output, noise in hypothesis.reading_noise.items():
        place = compiled.states.index(state_of(output))
        q[place], p0[place], forget[place] = noise.intensity, noise.sd**2, 1.0 / noise.time_s
    drive = np.append(flight.drive, np.zeros(len(q) - len(flight.drive)))
    rub = np.full(max(1, len(compiled.filter.axes)), 10.0**hypothesis.rest_doubt)
    return FilterNoise(q, rub, p0, drive, forget, flight.step_s)


def start_under(compiled: CompiledFilter, flight: FilteredLog) -> tuple[Array, Array]:
    """Where a flight starts and its variances, with what effects brought: a lag at what was read, all else at rest."""
    further, outputs = compiled.states[len(flight.x0) :], flight.log.columns.outputs
    own = {state: outputs.index(output) for state, output in compiled.follows.items()}
    read = [flight.first_read[own[s]] if s in own else 0.0 for s in further]
    sure = [flight.filter_input.r[0, own[s]] if s in own else START_SD**2 for s in further]
    return np.append(flight.x0, read), np.append(flight.p0, sure)


def passes(
    case: Case,
    hypothesis: Hypothesis,
    columns: Sequence[int] = (),
    *,
    noises: Sequence[tuple["Hypothesis", float]] = (),
    slopes: bool = False,
    gains: bool = False,
) -> list[Pass] | None:
    """The filter over all flights; None where it left all bounds on one. `noises` are hypotheses, each with another noise alone, and by how
    much it is other: by these numbers of the noise the likelihood's slopes are asked."""
    compiled = case.library.compiled(hypothesis.effects)
    of_all = coefficients(case, compiled, hypothesis)

    def over(flight: FilteredLog) -> Pass | None:
        here = hypothesis.over(flight)
        p = of_all if here is hypothesis else coefficients(case, compiled, here)
        filter_input = filter_input_under(case, compiled, flight, here)
        x0, noise = start_under(compiled, flight)[0], noise_of(case, compiled, flight, here)
        others = [(noise_of(case, compiled, flight, other.over(flight)), by) for other, by in noises]
        wanted = Wanted(case.slots, columns, [slope_of(noise, other, by) for other, by in others], slopes, gains)
        run = compiled.filter.run(filter_input, p, x0, noise, wanted, flight.locked)
        return None if run is None else replace(run, log_likelihood=run.log_likelihood + filter_input.known)

    runs = thread_map(over, case.flights)
    found = [run for run in runs if run is not None and np.isfinite(run.log_likelihood)]
    return found if len(found) == len(runs) else None


def as_noisy(case: Case, hypothesis: Hypothesis, other: Hypothesis) -> Hypothesis:
    """The hypothesis with all noise of another: noise predicts nothing, but says how sure a filter is of where a prediction begins."""
    effects = case.library.effects
    gusts = {name: values for name, values in other.effects.items() if effects[name].is_noise}
    kept = {name: values for name, values in hypothesis.effects.items() if not effects[name].is_noise}
    return hypothesis.with_effects({**kept, **gusts}).with_noise_of(other)
