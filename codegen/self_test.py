"""The fixed sequence of the emitted self-test, and what the twin answers to it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import nan
from typing import Protocol, SupportsFloat

from records.law_table import AxisRange, FlownTable
from records.loops import Loop

STEPS = 320
REFERENCE_EVERY = 64
MISSING_EVERY = 32
SEED = 20
MULTIPLIER = 1664525
INCREMENT = 1013904223
WIDEST_SPAN_COUNTS = 30000
MOVE_RAD, MOVE_SHARE = 0.02, 0.01


@dataclass(frozen=True)
class LoopTest:
    """Of one loop: how far its counts wander, by how many at a time, and the expected bits of its first and last voltage."""

    span_counts: int
    move_counts: int
    first: int
    last: int


@dataclass(frozen=True)
class SelfTest:
    """Parameters of the sequence, and the expected bits: first and last outputs, checksum over all."""

    steps: int
    reference_every: int
    missing_every: int
    seed: int
    multiplier: int
    increment: int
    loops: tuple[LoopTest, ...]
    checksum: int
    missing: int


class Twin(Protocol):
    """What the self-test asks of a twin; angles and voltages in rad and V, exactly what their words stand for."""

    def reset(self, *angles_rad: float) -> None:
        """Start at rest at these angles."""

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """One sample of references, then angles: the voltages."""

    def angle_from_counts(self, loop: int, counts: int) -> SupportsFloat:
        """Angle [rad] of an encoder count of the loop at this place."""

    def duty(self, loop: int, u_V: float) -> int:
        """Signed PWM ticks of a voltage of the loop at this place."""

    def voltage_word(self, u_V: float) -> int:
        """The 32 bits of a voltage."""

    @property
    def missing_word(self) -> int:
        """The 32 bits of a number that is none."""


def self_test(table: FlownTable, twin: Twin) -> SelfTest:
    """The self-test of `table`, its expected results computed by the twin of the arithmetic in question."""
    twin.reset(*[0.0] * len(table.loops))
    spans, moves = (
        [_span(axis) for axis in table.axes],
        [_move(loop, axis) for loop, axis in zip(table.loops, table.axes, strict=True)],
    )
    outputs = [twin.step(*given) for given in _sequence(twin, spans, moves)]
    ends = zip(*([twin.voltage_word(u_V) for u_V in outputs[step]] for step in (0, -1)), strict=True)
    return SelfTest(
        steps=STEPS,
        reference_every=REFERENCE_EVERY,
        missing_every=MISSING_EVERY,
        seed=SEED,
        multiplier=MULTIPLIER,
        increment=INCREMENT,
        loops=tuple(LoopTest(span, move, *words) for span, move, words in zip(spans, moves, ends, strict=True)),
        checksum=_checksum(twin, outputs),
        missing=twin.missing_word,
    )


def _sequence(twin: Twin, spans: Sequence[int], moves: Sequence[int]) -> Iterator[tuple[float, ...]]:
    """References and angles, number by number as in law_self_test.c; the measurement that is missing is the first loop's."""
    seed = SEED
    counts = [0] * len(spans)
    references_rad = [0.0] * len(spans)

    def random_count(span: int) -> int:
        nonlocal seed
        seed = (seed * MULTIPLIER + INCREMENT) % 2**32
        return (((seed >> 16) * (2 * span + 1)) >> 16) - span

    for step in range(STEPS):
        if step % REFERENCE_EVERY == 0:
            references_rad = [
                float(twin.angle_from_counts(loop, random_count(span))) for loop, span in enumerate(spans)
            ]
        counts = [
            _held(count + random_count(move), span) for count, move, span in zip(counts, moves, spans, strict=True)
        ]
        angles_rad = [float(twin.angle_from_counts(loop, count)) for loop, count in enumerate(counts)]
        if step % MISSING_EVERY == MISSING_EVERY - 1:
            angles_rad[0] = nan
        yield (*references_rad, *angles_rad)


def _checksum(twin: Twin, outputs: Sequence[Sequence[float]]) -> int:
    """FNV-1a over whole words: all outputs' bits, then all duties, of every step."""
    checksum = 2166136261
    for voltages_V in outputs:
        duties = [twin.duty(loop, u_V) for loop, u_V in enumerate(voltages_V)]
        for word in (*map(twin.voltage_word, voltages_V), *duties):
            checksum = ((checksum ^ (word % 2**32)) * 16777619) % 2**32
    return checksum


def _span(axis: AxisRange) -> int:
    """Counts that cover the axis' references, small enough for 32-bit products."""
    widest_rad = max(abs(axis.reference_min_rad), abs(axis.reference_max_rad))
    return max(1, min(WIDEST_SPAN_COUNTS, int(widest_rad / axis.resolution_rad)))


def _move(loop: Loop, axis: AxisRange) -> int:
    """Counts that one sample moves at most: of an angle MOVE_RAD, of anything else as small a share of its references' range."""
    move = MOVE_RAD if loop.output_unit == "rad" else MOVE_SHARE * (axis.reference_max_rad - axis.reference_min_rad)
    return max(1, min(_span(axis), int(move / axis.resolution_rad)))


def _held(counts: int, limit: int) -> int:
    return max(-limit, min(limit, counts))
