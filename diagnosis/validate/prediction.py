"""Free runs over consecutive windows of a log, each from the state that the model's own filter had from data up to its first row."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.filter_input import FilterInput
from diagnosis.filter.kalman import FilterNoise, Pass, Wanted
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis, coefficients, filter_input_under, noise_of, start_under
from diagnosis.library.effect_library import CompiledFilter
from diagnosis.library.sensor_effects import row_for
from sim.effect import Role, Values
from sim.paths.output_stages import OutputDelay, OutputLag, OutputSteps, Play
from sim.paths.path import OutputStage

Array = NDArray[np.float64]
WINDOW_S = 1.0
UNSEEN_VARIANCE = 1e8  # variance of a reading that the state shall not follow, in squares of its own unit


@dataclass(frozen=True)
class FreeRun:
    """A free run from the state estimated at row `start`; its rows from `first` to the one before `last` are wanted."""

    start: int
    first: int
    last: int


def predictions(
    case: Case, flight: FilteredLog, hypothesis: Hypothesis, spans: Sequence[FreeRun] | None = None
) -> Array:
    """Predicted readings (rows, outputs) of a log by free runs over `spans`, by default its windows of a second.

    NaN in rows of no span, and where the filter fails or cannot yet tell.
    """
    second_s = case.second_s
    library, hypothesis = case.library, hypothesis.over(flight)
    compiled = library.compiled(hypothesis.effects)
    filter_input = filter_input_under(case, compiled, flight, hypothesis)
    unforeseen_input = filter_input_under(case, compiled, _unforeseen(flight), hypothesis)
    given, noise = coefficients(case, compiled, hypothesis), noise_of(case, compiled, flight, hypothesis)
    chosen = compiled.filter
    places = np.tile(np.arange(len(filter_input.t_s))[:, None], (1, filter_input.y.shape[1]))
    whole = replace(filter_input, row=np.arange(len(filter_input.t_s)), place=places, rows=len(filter_input.t_s))
    run = chosen.run(whole, given, start_under(compiled, flight)[0], noise, Wanted(case.slots), flight.locked)
    outputs = len(library.bound.model.outputs)
    found = np.full((len(flight.log.t_s), outputs), np.nan)
    if run is None:
        return found
    lateness, t_s = _lateness(case, compiled, hypothesis.effects), flight.log.t_s
    spans = [FreeRun(first, first, last) for first, last in windows(t_s, second_s)] if spans is None else spans
    spans = [span for span in spans if t_s[span.start] >= t_s[0] + settled_after_s(t_s, second_s)]
    stretches = [_stretch(filter_input, t_s, span, max(lateness)) for span in spans]
    stretches = [stretch for stretch in stretches if stretch.begin >= 0]
    wanted = Wanted([place if place < outputs else -1 for place in range(len(library.outputs))])

    def free(part: FilterInput, begins: NDArray[np.int64]) -> Pass | None:
        return chosen.run(part, given, run.filtered[begins], _sure(noise), wanted, flight.locked)

    for stretch, y in zip(stretches, _left_alone(unforeseen_input, stretches, outputs, free), strict=True):
        if not np.isfinite(y).all():
            continue
        span, known_s = stretch.span, filter_input.t_s[stretch.begin : stretch.end]
        then = t_s[span.start : span.last]
        seen = np.column_stack([np.interp(then - lateness[k], known_s, y[:, k]) for k in range(outputs)])
        seen = _through_sensors(case, hypothesis.effects, flight.log.y[span.start], seen)
        found[span.first : span.last] = seen[span.first - span.start :]
    return found


class _Stretch(NamedTuple):
    """The instants of a filter input, from `begin`, below 0 where readings are older than the log, up to `end`, that a free run needs."""

    span: FreeRun
    begin: int
    end: int


def _stretch(filter_input: FilterInput, t_s: Array, span: FreeRun, oldest_s: float) -> _Stretch:
    begin = int(np.searchsorted(filter_input.t_s, t_s[span.start] - oldest_s + 1e-9, side="right")) - 1
    return _Stretch(span, begin, int(np.searchsorted(filter_input.t_s, t_s[span.last - 1] + 1e-9, side="right")))


def _left_alone(
    filter_input: FilterInput,
    stretches: Sequence[_Stretch],
    outputs: int,
    free: Callable[[FilterInput, NDArray[np.int64]], Pass | None],
) -> list[Array]:
    """What is read over each stretch (instants, outputs) by one run, `free`, that begins anew at each; NaN from where it is lost."""
    if not stretches:
        return []
    instants = np.concatenate([np.arange(stretch.begin, stretch.end) for stretch in stretches])
    firsts = np.cumsum([0, *(stretch.end - stretch.begin for stretch in stretches[:-1])])
    anew = np.full(len(instants), -1)
    anew[firsts] = np.arange(len(stretches))
    run = free(replace(_unseen(filter_input, instants, outputs), anew=anew), instants[firsts])
    assert run is not None  # what begins anew fails by stretches
    return np.split(-run.w * np.sqrt(run.s), firsts[1:])


def _sure(noise: FilterNoise) -> FilterNoise:
    """That of a plant which nothing drives, from a state that is known."""
    none = np.zeros_like(noise.q)
    return FilterNoise(none, np.zeros_like(noise.rub), none, none, noise.forget, 0.0)


def settled_after_s(t_s: Array, second_s: float) -> float:
    """How long the filter runs along a log before predictions begin; `second_s` as of sim.model.Model."""
    return decisions.SETTLE_S * _pace(t_s, second_s)


def _pace(t_s: Array, second_s: float) -> float:
    """`second_s` for a log that has room for a window behind what the filter needs, and for one of few rows; less for a short one of
    many, as fast plants give."""
    room = float(t_s[-1] - t_s[0]) / (decisions.SETTLE_S + WINDOW_S)
    return min(second_s, room) if len(t_s) >= decisions.SHORT_ROWS else second_s


def windows(t_s: Array, second_s: float, length_s: float = WINDOW_S) -> list[tuple[int, int]]:
    """First row and row after the last of each window, which lasts `length_s` of the plant's seconds."""
    number = np.floor((t_s - t_s[0]) / (length_s * _pace(t_s, second_s)) + 1e-9).astype(int)
    edges = [0, *(np.flatnonzero(np.diff(number)) + 1).tolist(), len(t_s)]
    return [(first, last) for first, last in pairwise(edges) if last - first > 1]


def _unforeseen(flight: FilteredLog) -> FilteredLog:
    """The flight without what its own readings say of lost frames: a prediction knows only how many are lost."""
    filter_input = flight.filter_input
    return (
        replace(flight, filter_input=replace(filter_input, lost=np.zeros_like(filter_input.lost)))
        if filter_input.lost.any()
        else flight
    )


def _lateness(case: Case, compiled: CompiledFilter, effects: Mapping[str, Values]) -> list[float]:
    """How old each output's readings are."""
    library = case.library
    found = [0.0] * len(library.bound.model.outputs)
    for name, values in effects.items():
        effect = library.effects[name]
        lateness = effect.having(Role.LATENESS)
        if effect.on_output is not None and lateness is not None and name not in compiled.names:
            found[effect.on_output(values).output] += values[lateness.symbol]
    return found


def _unseen(filter_input: FilterInput, instants: NDArray[np.int64], outputs: int) -> FilterInput:
    """Some instants of a filter input whose readings are nothing but questions."""
    count = len(instants)
    y = np.full((count, filter_input.y.shape[1]), np.nan)
    y[:, :outputs] = 0.0
    return FilterInput(
        filter_input.t_s[instants],
        filter_input.u[instants],
        y,
        r=np.full_like(y, UNSEEN_VARIANCE),
        read=y,
        standing=np.ones_like(y),
        single=filter_input.single,
        row=np.arange(count),
        place=np.tile(np.arange(count)[:, None], (1, y.shape[1])),
        rows=count,
        usual=np.zeros_like(y),
        lost=np.zeros(count),
        loss_power=np.zeros(count),
        untold_s=np.zeros(count),
        added=filter_input.added,
    )


def _through_sensors(case: Case, effects: Mapping[str, Values], read: Array, predicted: Array) -> Array:
    """What play and coarse encoders make of the predicted readings (rows, outputs) of one free run; `read` are its first.

    Raises NotImplementedError for a stage that READ does not know.
    """
    found = predicted.copy()
    for name, values in effects.items():
        on_output = case.library.effects[name].on_output
        if on_output is not None:
            stage = on_output(values)
            reads = row_for(READ, stage, "READ of diagnosis/validate/prediction.py")
            found[:, stage.output] = reads(stage, found[:, stage.output], float(read[stage.output]))
    return found


def _as_it_is(stage: OutputStage, predicted: Array, read: float) -> Array:
    """A stage that is late alone: the readings are asked for when they were true."""
    return predicted


def _in_steps(stage: OutputSteps, predicted: Array, read: float) -> Array:
    return np.asarray(stage.q * np.round(predicted / stage.q))


def _behind_play(stage: Play, predicted: Array, read: float) -> Array:
    """What a reading behind play follows of the predicted angle, from the first reading on."""
    if not np.isfinite(predicted).all():
        return predicted
    stands, found = read if np.isfinite(read) else float(predicted[0]), predicted.copy()
    for row, angle in enumerate(predicted.tolist()):
        stands = min(max(stands, angle - 0.5 * stage.width), angle + 0.5 * stage.width)
        found[row] = stands
    return found


# What a reading behind each kind of stage shows: (stage, predicted (rows,), first reading) -> (rows,).
READ: Mapping[type, Callable[[Any, Array, float], Array]] = {
    OutputDelay: _as_it_is,
    OutputLag: _as_it_is,
    OutputSteps: _in_steps,
    Play: _behind_play,
}
