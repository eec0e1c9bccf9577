"""Columns that were taken for each other, turned in sign, written in another unit, or that stand still: of the inputs, read off the log."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, combinations, permutations

import numpy as np
from numpy.typing import NDArray

from records.table import ControllerTable
from records.text.units import unit_of, units_of
from replay import thresholds
from replay.flight import ReplayedLog
from replay.law import Channel
from replay.variants import Variant

Array = NDArray[np.float64]

EXCHANGED, TURNED, UNIT, SCALED, OFFSET, CONSTANT = (
    "outputs_exchanged",
    "output_sign",
    "output_unit",
    "output_scaled",
    "output_offset",
    "input_constant",
)
INPUTS_EXCHANGED, INPUT_SIGN = "inputs_exchanged", "input_sign"
OF_THE_COLUMNS = (EXCHANGED, TURNED, UNIT, SCALED, OFFSET, CONSTANT, INPUTS_EXCHANGED, INPUT_SIGN)


@dataclass(frozen=True)
class _Line:
    """An input as a line of the law's output: gain u + offset_V."""

    gain: float
    offset_V: float


def given_columns(table: ControllerTable) -> Iterator[Variant]:
    """References or angles taken for each other, one of these two with its sign turned too, and each of all so alone."""
    names, count = [loop.axis for loop in table.loops], 2 * len(table.loops)
    for begin, what in ((0, "references"), (len(names), "angles")):
        for one, other in combinations(range(len(names)), 2):
            columns = list(range(count))
            columns[begin + one], columns[begin + other] = begin + other, begin + one
            which = "two" if len(names) == 2 else f"{names[one]} and {names[other]}"
            sentence = f"takes its {which} {what} for each other, or the log has these columns exchanged"
            yield Variant(INPUTS_EXCHANGED, "columns", sentence, partial(replace, columns=tuple(columns)))
            for place in (begin + one, begin + other):
                turned = f"{sentence}, and the {names[place - begin]}'s with the other sign"
                change = partial(replace, columns=tuple(columns), signs=_turned(place, count))
                yield Variant(f"{INPUTS_EXCHANGED} + {INPUT_SIGN}", "columns", turned, change)
    given = [f"{name} {what}" for what in ("reference", "angle") for name in names]
    for place, what in enumerate(given):
        sentence = f"takes the {what} with the other sign than the log"
        yield Variant(INPUT_SIGN, "columns", sentence, partial(replace, signs=_turned(place, count)))


def _turned(place: int, count: int) -> tuple[float, ...]:
    return tuple(-1.0 if column == place else 1.0 for column in range(count))


def constant_inputs(flight: ReplayedLog, names: Sequence[str]) -> Iterator[Variant]:
    """Inputs that stand still in the log, whatever the law answers."""
    still = [float(column[0]) if np.nanmin(column) == np.nanmax(column) else None for column in flight.logged_V.T]
    if all(value is None for value in still):
        return
    low, high = ([outside if value is None else value for value in still] for outside in (-1e9, 1e9))
    shown = " and ".join(
        f"{name} stands at {value:g} {unit_of(name)}".rstrip()
        for name, value in zip(names, still, strict=True)
        if value is not None
    )
    sentence = f"does not drive all inputs: {shown} throughout, whatever its law answers"
    yield Variant(
        CONSTANT,
        "channel",
        sentence,
        partial(replace, channel=Channel(low_V=tuple(low), high_V=tuple(high))),
    )


def output_lines(own_V: Array, logged_V: Array, names: Sequence[str]) -> Iterator[Variant]:
    """All logged inputs (n, loops) as lines of the law's answers, alike: exchanged, turned, in another unit, or set off."""
    own = tuple(range(own_V.shape[1]))
    which = "its two" if len(own) == 2 else "some of its"
    for source in permutations(own):
        found = [_line(own_V[:, of], logged_V[:, place]) for place, of in enumerate(source)]
        lines = [line for line in found if line is not None and line.gain != 0.0]
        if len(lines) < len(own) or (source == own and all(line == _Line(1.0, 0.0) for line in lines)):
            continue
        told = [
            [(EXCHANGED, f"exchanges {which} outputs, or the log has these columns exchanged")] if source != own else []
        ]
        told += [list(_told(line, name)) for line, name in zip(lines, names, strict=True)]
        kinds = dict.fromkeys(kind for kind, _ in chain(*told))
        clauses = "; it ".join(sentence for _, sentence in chain(*told))
        channel = Channel(source, tuple(line.gain for line in lines), tuple(line.offset_V for line in lines))
        yield Variant(" + ".join(kinds), "channel", clauses, partial(replace, channel=channel))


def _line(own_V: Array, logged_V: Array) -> _Line | None:
    """The line of one input; None where it is none."""
    known = np.isfinite(logged_V)
    own, logged = own_V[known], logged_V[known]
    scale = float(np.abs(logged).max())
    if np.ptp(own) < thresholds.MOVES_V or scale == 0.0:
        return None
    gain, offset_V = np.polyfit(own, logged, 1)
    line = _Line(_rounded(float(gain), 1.0), _rounded(float(offset_V), scale))
    return line if np.abs(line.gain * own + line.offset_V - logged).max() < thresholds.NEAR_SHARE * scale else None


def _rounded(value: float, scale: float) -> float:
    """A few digits where the number has no more: people write 1000 and not 999.9998."""
    if abs(value) < thresholds.WHOLE_FACTOR * scale:
        return 0.0
    short = float(f"{value:.5g}")
    return short if abs(short - value) < thresholds.WHOLE_FACTOR * max(scale, abs(value)) else value


def _told(line: _Line, name: str) -> Iterator[tuple[str, str]]:
    gain = abs(line.gain)
    if line.gain < 0.0:
        yield TURNED, f"sends {name} with its sign turned, or the log has it so"
    if gain != 1.0:
        is_unit = abs(math.log10(gain) - round(math.log10(gain))) < thresholds.WHOLE_FACTOR
        kind, why = (UNIT, "another unit") if is_unit else (SCALED, "another scale")
        yield kind, f"has {gain:g} times its law's answer logged as {name} ({why})"
    if line.offset_V != 0.0:
        yield (
            OFFSET,
            f"sends {name} {abs(line.offset_V):.6g} {units_of([name])} {'above' if line.offset_V > 0.0 else 'below'} its law's answer",
        )
