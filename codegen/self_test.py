"""The fixed sequence of the emitted self-test, and what the twin answers to it."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import nan
from typing import Protocol, SupportsFloat

from records.law_table import AxisRange, FlownTable

STEPS = 320
REFERENCE_EVERY = 64
MISSING_EVERY = 32
SEED = 20
MULTIPLIER = 1664525
INCREMENT = 1013904223
WIDEST_SPAN_COUNTS = 30000
MOVE_RAD = 0.02

Given = tuple[float, float, float, float]


@dataclass(frozen=True)
class SelfTest:
    """Parameters of the sequence, and the expected bits: first and last outputs, checksum over all."""

    steps: int
    reference_every: int
    missing_every: int
    seed: int
    multiplier: int
    increment: int
    psi_span_counts: int
    phi_span_counts: int
    psi_move_counts: int
    phi_move_counts: int
    first: tuple[int, int]
    last: tuple[int, int]
    checksum: int
    missing: int


class Twin(Protocol):
    """What the self-test asks of a twin; angles and voltages in rad and V, exactly what their words stand for."""

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Start at rest at these angles."""

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]:
        """One sample: u_M_V, u_T_V."""

    def angle_from_counts_psi(self, counts: int) -> SupportsFloat:
        """Elevation [rad] of an encoder count."""

    def angle_from_counts_phi(self, counts: int) -> SupportsFloat:
        """Azimuth [rad] of an encoder count."""

    def duty_main(self, u_V: float) -> int:
        """Signed PWM ticks of the main rotor's voltage."""

    def duty_tail(self, u_V: float) -> int:
        """Signed PWM ticks of the tail rotor's voltage."""

    def voltage_word(self, u_V: float) -> int:
        """The 32 bits of a voltage."""

    @property
    def missing_word(self) -> int:
        """The 32 bits of a number that is none."""


def self_test(table: FlownTable, twin: Twin) -> SelfTest:
    """The self-test of `table`, its expected results computed by the twin of the arithmetic in question."""
    twin.reset(0.0, 0.0)
    spans = (_span(table.elevation), _span(table.azimuth))
    moves = (_move(table.elevation), _move(table.azimuth))
    outputs = [twin.step(*given) for given in _sequence(twin, spans, moves)]
    return SelfTest(
        steps=STEPS,
        reference_every=REFERENCE_EVERY,
        missing_every=MISSING_EVERY,
        seed=SEED,
        multiplier=MULTIPLIER,
        increment=INCREMENT,
        psi_span_counts=spans[0],
        phi_span_counts=spans[1],
        psi_move_counts=moves[0],
        phi_move_counts=moves[1],
        first=(twin.voltage_word(outputs[0][0]), twin.voltage_word(outputs[0][1])),
        last=(twin.voltage_word(outputs[-1][0]), twin.voltage_word(outputs[-1][1])),
        checksum=_checksum(twin, outputs),
        missing=twin.missing_word,
    )


def _sequence(twin: Twin, spans: tuple[int, int], moves: tuple[int, int]) -> Iterator[Given]:
    """References and angles, number by number as in law_self_test.c."""
    seed = SEED
    psi_counts = phi_counts = 0
    references: tuple[SupportsFloat, SupportsFloat] = (0.0, 0.0)

    def random_count(span: int) -> int:
        nonlocal seed
        seed = (seed * MULTIPLIER + INCREMENT) % 2**32
        return (((seed >> 16) * (2 * span + 1)) >> 16) - span

    for step in range(STEPS):
        if step % REFERENCE_EVERY == 0:
            psi_ref_rad = twin.angle_from_counts_psi(random_count(spans[0]))
            references = (psi_ref_rad, twin.angle_from_counts_phi(random_count(spans[1])))
        psi_counts = _held(psi_counts + random_count(moves[0]), spans[0])
        phi_counts = _held(phi_counts + random_count(moves[1]), spans[1])
        missing = step % MISSING_EVERY == MISSING_EVERY - 1
        psi_rad = nan if missing else float(twin.angle_from_counts_psi(psi_counts))
        yield float(references[0]), float(references[1]), psi_rad, float(twin.angle_from_counts_phi(phi_counts))


def _checksum(twin: Twin, outputs: list[tuple[float, float]]) -> int:
    """FNV-1a over whole words: both outputs' bits and both duties of every step."""
    checksum = 2166136261
    for u_M_V, u_T_V in outputs:
        duties = (twin.duty_main(u_M_V), twin.duty_tail(u_T_V))
        for word in (twin.voltage_word(u_M_V), twin.voltage_word(u_T_V), *duties):
            checksum = ((checksum ^ (word % 2**32)) * 16777619) % 2**32
    return checksum


def _span(axis: AxisRange) -> int:
    """Counts that cover the axis' references, small enough for 32-bit products."""
    widest_rad = max(abs(axis.reference_min_rad), abs(axis.reference_max_rad))
    return max(1, min(WIDEST_SPAN_COUNTS, int(widest_rad / axis.resolution_rad)))


def _move(axis: AxisRange) -> int:
    return max(1, min(_span(axis), int(MOVE_RAD / axis.resolution_rad)))


def _held(counts: int, limit: int) -> int:
    return max(-limit, min(limit, counts))
