"""What the board says, as records in SI units."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from records.loops import Loop
from records.protocol import PROTOCOL
from rig.link.frames import Frame, Received
from rig.link.numbers import Numbers


@dataclass(frozen=True)
class Identity:
    """Who the board is; digests as hexadecimal digits."""

    schema_hash: str
    table_digest: str
    arithmetic: str
    sample_period_s: float
    pwm_full_scale_ticks: int
    firmware_version: str
    unique_id: str
    reset_cause: str
    state: int


@dataclass(frozen=True)
class Answer:
    """The law's answer to one sample, in the order of its loops."""

    voltages_V: tuple[float, ...]
    duties_ticks: tuple[int, ...]
    law_cycles: int
    device_time_us: int


@dataclass(frozen=True)
class Telemetry:
    """One control tick of a flight on the board's own sensors, in the order of the law's loops."""

    tick: int
    device_time_us: int
    state: int
    echo_sequence: int
    counts: tuple[int, ...]
    angles_rad: tuple[float, ...]
    references_rad: tuple[float, ...]
    voltages_V: tuple[float, ...]
    duties_ticks: tuple[int, ...]
    law_cycles: int
    frames_refused: int
    frames_lost: int
    tick_overruns: int


@dataclass(frozen=True)
class Health:
    """State of the supervisor by name, the board's counters by name, and what the host received of it."""

    state: str
    counters: Mapping[str, int]
    received: Received


def identity(frame: Frame) -> Identity:
    """The record of an IDENTITY frame."""
    version = frame.number("firmware_version")
    return Identity(
        schema_hash=frame.octets("schema_hash").hex(),
        table_digest=frame.octets("table_digest").hex(),
        arithmetic=PROTOCOL.enumeration("arithmetic").sentence(frame.number("arithmetic")),
        sample_period_s=frame.number("sample_period_us") * 1e-6,
        pwm_full_scale_ticks=frame.number("pwm_full_scale_ticks"),
        firmware_version=f"{version >> 8}.{version & 0xFF}",
        unique_id=frame.octets("unique_id").hex(),
        reset_cause=PROTOCOL.enumeration("reset_cause").sentence(frame.number("reset_cause")),
        state=frame.number("state"),
    )


def answer(frame: Frame, numbers: Numbers, loops: Sequence[Loop]) -> Answer:
    """The record of an ANSWER frame of a law of `loops`."""
    return Answer(
        voltages_V=_numbers(frame, numbers, (loop.input for loop in loops), "V"),
        duties_ticks=tuple(frame.number(loop.duty) for loop in loops),
        law_cycles=frame.number("law_cycles"),
        device_time_us=frame.number("device_time_us"),
    )


_PLAIN = (
    "tick",
    "device_time_us",
    "state",
    "echo_sequence",
    "law_cycles",
    "frames_refused",
    "frames_lost",
    "tick_overruns",
)


def telemetry(frame: Frame, numbers: Numbers, loops: Sequence[Loop]) -> Telemetry:
    """The record of a TELEMETRY frame of a law of `loops`."""
    return Telemetry(
        counts=tuple(frame.number(loop.counts) for loop in loops),
        angles_rad=_numbers(frame, numbers, (loop.output for loop in loops), "rad"),
        references_rad=_numbers(frame, numbers, (loop.reference for loop in loops), "rad"),
        voltages_V=_numbers(frame, numbers, (loop.input for loop in loops), "V"),
        duties_ticks=tuple(frame.number(loop.duty) for loop in loops),
        **{name: frame.number(name) for name in _PLAIN},
    )


def _numbers(frame: Frame, numbers: Numbers, names: Iterable[str], unit: str) -> tuple[float, ...]:
    return tuple(numbers.from_word(frame.number(name), unit) for name in names)


def health(frame: Frame, received: Received) -> Health:
    """The record of a COUNTERS frame, the counters in their declared order; `received` is the host's own side."""
    head = ("echo_sequence", "device_time_us", "state")
    counters = {part.name: frame.number(part.name) for part in frame.message.fields if part.name not in head}
    return Health(state_name(frame.number("state")), counters, received)


def state_name(code: int) -> str:
    """The supervisor's state as the protocol names it; its number where the protocol knows none."""
    return next((choice.name for choice in PROTOCOL.enumeration("state").choices if choice.code == code), str(code))
