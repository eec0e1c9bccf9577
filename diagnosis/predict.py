"""Free runs over consecutive windows of a log, each from the state that the model's own filter had from data up to its first row."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from diagnosis.case import Case, Flight
from diagnosis.filter import Noise
from diagnosis.hypothesis import Supposed, coefficients, noise_of, start_under, tape_under
from diagnosis.kit import Variant
from diagnosis.tape import Tape
from sim.effects.effect import Values

Array = NDArray[np.float64]
WINDOW_S = 1.0
SETTLE_S = 2.0  # until then the filter cannot tell the speeds well enough
UNSEEN = 1e8  # variance of a reading that the state shall not follow, in squares of its own unit


def predictions(case: Case, flight: Flight, supposed: Supposed, rub_s: float = 0.02) -> Array:
    """Predicted readings (rows, outputs) of a log by window; NaN where the filter fails or cannot yet tell."""
    kit = case.kit
    variant = kit.variant(supposed.effects)
    tape = tape_under(case, variant, flight, supposed.effects)
    ahead_tape = tape_under(case, variant, _unforeseen(flight), supposed.effects)
    given, noise = coefficients(case, variant, supposed), noise_of(case, variant, flight, supposed, rub_s)
    chosen = variant.filter
    places = np.tile(np.arange(len(tape.t_s))[:, None], (1, tape.y.shape[1]))
    whole = replace(tape, row=np.arange(len(tape.t_s)), place=places, rows=len(tape.t_s))
    run = chosen.run(whole, given, start_under(variant, flight)[0], noise, case.slots, locked=flight.locked)
    outputs = len(kit.bound.model.outputs)
    found = np.full((len(flight.log.t_s), outputs), np.nan)
    if run is None:
        return found
    lateness = _lateness(case, variant, supposed.effects)
    ahead = Noise(np.zeros_like(noise.q), np.zeros_like(noise.rub), np.zeros_like(noise.p0), np.zeros_like(noise.q))
    slots = [place if place < outputs else -1 for place in range(len(kit.outputs))]
    for first, last in windows(flight.log.t_s):
        begin = int(np.searchsorted(tape.t_s, flight.log.t_s[first] - max(lateness) + 1e-9, side="right")) - 1
        end = int(np.searchsorted(tape.t_s, flight.log.t_s[last - 1] + 1e-9, side="right"))
        if begin < 0 or flight.log.t_s[first] < flight.log.t_s[0] + SETTLE_S:
            continue
        part = _unseen(ahead_tape, begin, end, outputs)
        free = chosen.run(part, given, run.filtered[begin], ahead, slots, locked=flight.locked)
        if free is None:
            continue
        y = -free.w * np.sqrt(free.s)
        for output in range(outputs):
            then = flight.log.t_s[first:last] - lateness[output]
            found[first:last, output] = np.interp(then, part.t_s, y[:, output])
    for name, values in supposed.effects.items():
        place, kind = name.split(".")
        if place in kit.bound.model.places.sensors and kind in ("backlash", "quantization"):
            output = kit.outputs.index(kit.bound.model.places.sensors[place].output)
            if kind == "backlash":
                _behind_play(flight, found[:, output], flight.log.y[:, output], values["width"])
            else:
                found[:, output] = values["q"] * np.round(found[:, output] / values["q"])
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
        untold_s=np.zeros(count),
    )


def _behind_play(flight: Flight, predicted: Array, read: Array, width: float) -> None:
    """What a reading behind play follows of the predicted angle, in place; each window starts from its own first reading."""
    for first, last in windows(flight.log.t_s):
        if not np.isfinite(predicted[first:last]).all():
            continue
        stands = read[first] if np.isfinite(read[first]) else predicted[first]
        for row in range(first, last):
            stands = min(max(stands, predicted[row] - 0.5 * width), predicted[row] + 0.5 * width)
            predicted[row] = stands
