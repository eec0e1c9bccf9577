"""What the board says, as records in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass

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
    """The law's answer to one sample."""

    u_M_V: float
    u_T_V: float
    duty_main_ticks: int
    duty_tail_ticks: int
    law_cycles: int
    device_time_us: int


@dataclass(frozen=True)
class Telemetry:
    """One control tick of a flight on the board's own encoders."""

    tick: int
    device_time_us: int
    state: int
    echo_sequence: int
    psi_counts: int
    phi_counts: int
    psi_rad: float
    phi_rad: float
    psi_ref_rad: float
    phi_ref_rad: float
    u_M_V: float
    u_T_V: float
    duty_main_ticks: int
    duty_tail_ticks: int
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


def answer(frame: Frame, numbers: Numbers) -> Answer:
    """The record of an ANSWER frame."""
    return Answer(
        u_M_V=numbers.from_word(frame.number("u_M_V"), "V"),
        u_T_V=numbers.from_word(frame.number("u_T_V"), "V"),
        duty_main_ticks=frame.number("duty_main_ticks"),
        duty_tail_ticks=frame.number("duty_tail_ticks"),
        law_cycles=frame.number("law_cycles"),
        device_time_us=frame.number("device_time_us"),
    )


def telemetry(frame: Frame, numbers: Numbers) -> Telemetry:
    """The record of a TELEMETRY frame."""
    words = {part.name: part.unit for part in frame.message.fields if part.is_number}
    values = {name: numbers.from_word(frame.number(name), unit) for name, unit in words.items()}
    counts = {name: frame.number(name) for name in Telemetry.__dataclass_fields__ if name not in words}
    return Telemetry(**values, **counts)  # type: ignore[arg-type]


def health(frame: Frame, received: Received) -> Health:
    """The record of a COUNTERS frame, the counters in their declared order; `received` is the host's own side."""
    head = ("echo_sequence", "device_time_us", "state")
    counters = {part.name: frame.number(part.name) for part in frame.message.fields if part.name not in head}
    return Health(state_name(frame.number("state")), counters, received)


def state_name(code: int) -> str:
    """The supervisor's state as the protocol names it; its number where the protocol knows none."""
    return next((choice.name for choice in PROTOCOL.enumeration("state").choices if choice.code == code), str(code))
