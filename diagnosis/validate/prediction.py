"""Free runs over consecutive windows of a log, each from the state that the model's own filter had from data up to its first row."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import Tape
from diagnosis.filter.kalman import Noise
from diagnosis.hypothesis.case import Case, Flight
from diagnosis.hypothesis.hypothesis import Supposed, coefficients, noise_of, start_under, tape_under
from diagnosis.library.effect_library import Variant
from sim.effect import Values

Array = NDArray[np.float64]
WINDOW_S = 1.0
SETTLE_S = 2.0  # until then the filter cannot tell the speeds well enough
UNSEEN = 1e8  # variance of a reading that the state shall not follow, in squares of its own unit


@dataclass(frozen=True)
class Span:
    """A free run from the state estimated at row `start`; its rows from `first` to the one before `last` are wanted."""

    start: int
    first: int
    last: int


def predictions(case: Case, flight: Flight, supposed: Supposed, spans: Sequence[Span] | None = None) -> Array:
    """Predicted readings (rows, outputs) of a log by free runs over `spans`, by default its windows of a second.

    NaN in rows of no span, and where the filter fails or cannot yet tell.
    """
    kit = case.kit
    variant = kit.variant(supposed.effects)
    tape = tape_under(case, variant, flight, supposed.effects)
    ahead_tape = tape_under(case, variant, _unforeseen(flight), supposed.effects)
    given, noise = coefficients(case, variant, supposed), noise_of(case, variant, flight, supposed)
    chosen = variant.filter
    places = np.tile(np.arange(len(tape.t_s))[:, None], (1, tape.y.shape[1]))
    whole = replace(tape, row=np.arange(len(tape.t_s)), place=places, rows=len(tape.t_s))
    run = chosen.run(whole, given, start_under(variant, flight)[0], noise, case.slots, locked=flight.locked)
    outputs = len(kit.bound.model.outputs)
    found = np.full((len(flight.log.t_s), outputs), np.nan)
    if run is None:
        return found
    lateness = _lateness(case, variant, supposed.effects)
    ahead = Noise(
        np.zeros_like(noise.q), np.zeros_like(noise.rub), np.zeros_like(noise.p0), np.zeros_like(noise.q), 0.0
    )
    slots = [place if place < outputs else -1 for place in range(len(kit.outputs))]
    t_s = flight.log.t_s
    for span in [Span(first, first, last) for first, last in windows(t_s)] if spans is None else spans:
        begin = int(np.searchsorted(tape.t_s, t_s[span.start] - max(lateness) + 1e-9, side="right")) - 1
        end = int(np.searchsorted(tape.t_s, t_s[span.last - 1] + 1e-9, side="right"))
        if begin < 0 or t_s[span.start] < t_s[0] + SETTLE_S:
            continue
        part = _unseen(ahead_tape, begin, end, outputs)
        free = chosen.run(part, given, run.filtered[begin], ahead, slots, locked=flight.locked)
        if free is None:
            continue
        y, then = -free.w * np.sqrt(free.s), t_s[span.start : span.last]
        seen = np.column_stack([np.interp(then - lateness[k], part.t_s, y[:, k]) for k in range(outputs)])
        _through_sensors(case, supposed.effects, flight.log.y[span.start], seen)
        found[span.first : span.last] = seen[span.first - span.start :]
    return found


def windows(t_s: Array) -> list[tuple[int, int]]:
    """First row and row after the last of each window."""
    number = np.floor((t_s - t_s[0]) / WINDOW_S + 1e-9).astype(int)
    edges = [0, *(np.flatnonzero(np.diff(number)) + 1).tolist(), len(t_s)]
    return [(first, last) for first, last in pairwise(edges) if last - first > 1]


def _unforeseen(flight: Flight) -> Flight:
    """The flight without what its own readings say of lost frames: a prediction knows only how many are lost."""
    tape = flight.tape
    return replace(flight, tape=replace(tape, lost=np.zeros_like(tape.lost))) if tape.lost.any() else flight


def _lateness(case: Case, variant: Variant, effects: Mapping[str, Values]) -> list[float]:
    """How old each output's readings are."""
    kit = case.kit
    found = [0.0] * len(kit.bound.model.outputs)
    for name, values in effects.items():
        place, kind = name.split(".")
        if place in kit.bound.model.places.sensors and kind in ("delay", "lag") and name not in variant.names:
            found[kit.outputs.index(kit.bound.model.places.sensors[place].output)] += values["tau"]
    return found


def _unseen(tape: Tape, begin: int, end: int, outputs: int) -> Tape:
    """A stretch of a tape whose readings are nothing but questions."""
    count = end - begin
    y = np.full((count, tape.y.shape[1]), np.nan)
    y[:, :outputs] = 0.0
    return Tape(
        tape.t_s[begin:end],
        tape.u[begin:end],
        y,
        r=np.full_like(y, UNSEEN),
        read=y,
        standing=np.ones_like(y),
        single=tape.single,
        row=np.arange(count),
        place=np.tile(np.arange(count)[:, None], (1, y.shape[1])),
        rows=count,
        usual=np.zeros_like(y),
        lost=np.zeros(count),
        loss_power=np.zeros(count),
        untold_s=np.zeros(count),
    )


def _through_sensors(case: Case, effects: Mapping[str, Values], read: Array, predicted: Array) -> None:
    """What play and coarse encoders make of the predicted readings (rows, outputs) of one free run, in place; `read` are its first."""
    kit = case.kit
    for name, values in effects.items():
        place, kind = name.split(".")
        if place in kit.bound.model.places.sensors and kind in ("backlash", "quantization"):
            output = kit.outputs.index(kit.bound.model.places.sensors[place].output)
            if kind == "backlash":
                _behind_play(predicted[:, output], float(read[output]), values["width"])
            else:
                predicted[:, output] = values["q"] * np.round(predicted[:, output] / values["q"])


def _behind_play(predicted: Array, read: float, width: float) -> None:
    """What a reading behind play follows of the predicted angle, in place, from the first reading on."""
    if not np.isfinite(predicted).all():
        return
    stands = read if np.isfinite(read) else float(predicted[0])
    for row, angle in enumerate(predicted.tolist()):
        stands = min(max(stands, angle - 0.5 * width), angle + 0.5 * width)
        predicted[row] = stands
