"""The serial protocol, declared once for a law of any loops: C structures, C codecs and the Python codec are all derived from it.

Frame on the line: COBS(version | type | sequence (2) | payload | CRC-32 over all before (4)) 0x00, little-endian.
"""

from dataclasses import dataclass
from functools import cache

from records.loops import LOOPS, Loop
from records.text.units import unit_of
from records.wire import I16, I32, U8, U16, U32, Choice, Constant, Enumeration, Field, Message, Protocol


def _number(name: str, unit: str, meaning: str) -> Field:
    return Field(name, U32, unit, meaning, is_number=True)


def _count(name: str, meaning: str) -> Field:
    return Field(name, U32, "1", meaning)


_HEAD = (
    Field("echo_sequence", U16, "1", "sequence number of the last frame that the board accepted"),
    Field("device_time_us", U32, "us", "the board's own clock, modulo 2^32"),
    Field("state", U8, "state", "state of the supervisor"),
)
_LAW_CYCLES = Field("law_cycles", U32, "core cycles", "duration of the last step of the law")
_TICK = Field("tick", U32, "1", "control ticks since the start")
_ARM = (
    Field("mode", U8, "mode", "wanted mode"),
    Field("digest_head", U8, "1", "first bytes of the expected table digest", count=8),
)
_MISMATCHES = Field("mismatches", U32, "1", "outputs that differ from the expected bits")
_IDENTITY = (
    Field("schema_hash", U8, "1", "hash of this protocol's declaration", count=8),
    Field("table_digest", U8, "1", "SHA-256 of the controller table", count=32),
    Field("arithmetic", U8, "arithmetic", "arithmetic of the law"),
    Field("sample_period_us", U32, "us", "control period"),
    Field("pwm_full_scale_ticks", U16, "PWM ticks", "duty of full voltage"),
    Field("firmware_version", U16, "1", "version of the firmware: major * 256 + minor"),
    Field("unique_id", U8, "1", "serial number of the chip", count=12),
    Field("reset_cause", U8, "reset_cause", "why the board started"),
)
_RESULT = (
    Field("command", U8, "message type", "the command that this answers"),
    Field("reason", U8, "reason", "outcome"),
)
_TELEMETRY_COUNTS = (
    _count("frames_refused", "frames that reached the board and were not accepted"),
    _count("frames_lost", "gaps in the host's sequence numbers"),
    _count("tick_overruns", "ticks that came before the step of the last had finished"),
)
_COUNTERS = (
    _count("frames_accepted", "frames accepted"),
    _count("cobs_errors", "frames that are no COBS block"),
    _count("too_long", "frames longer than any message"),
    _count("too_short", "frames shorter than header and CRC"),
    _count("crc_errors", "frames with a wrong CRC"),
    _count("wrong_version", "frames of another protocol version"),
    _count("unknown_type", "frames of a type that the board does not take"),
    _count("wrong_length", "frames whose length is not that of their type"),
    _count("stale", "frames older than the last accepted one"),
    _count("repeated", "accepted frames that repeat the last one"),
    _count("frames_lost", "gaps in the host's sequence numbers"),
    _count("uart_overruns", "bytes lost in the USART"),
    _count("uart_framing_errors", "bytes without a stop bit"),
    _count("uart_noise_errors", "bytes with noise"),
    _count("rx_ring_overflows", "bytes lost for want of room in the receive ring"),
    _count("tx_frames_dropped", "frames not sent for want of room in the transmit ring"),
    _count("tick_overruns", "ticks that came before the step of the last had finished"),
    _count("host_losses", "times that the host was lost while armed"),
    _count("encoder_faults", "times that an encoder was not believed while flying"),
    _count("resets", "resets since power on"),
)

_ENUMERATIONS = (
    Enumeration(
        "mode",
        "What ARM asks for.",
        (
            Choice("FLYING", 1, "flying on the board's own encoders, references from the host"),
            Choice(
                "LOOP", 2, "host in the loop: the host sends angles, the board answers inputs; the power stage is off"
            ),
        ),
    ),
    Enumeration(
        "state",
        "State of the supervisor.",
        (
            Choice("DISARMED", 0, "disarmed, power stage off"),
            Choice("FLYING", 1, "flying on its own encoders"),
            Choice("LOOP", 2, "host in the loop"),
            Choice("RAMPING", 3, "the host was lost or an encoder failed, the inputs ramp to the safe value"),
            Choice("LOST", 4, "the host was lost or an encoder failed, inputs at the safe value until armed again"),
        ),
    ),
    Enumeration(
        "reason",
        "Outcome of a command.",
        (
            Choice("DONE", 0, "done"),
            Choice("WRONG_TABLE", 1, "the board carries another controller table than the host expects"),
            Choice("OTHER_MODE", 2, "the board is armed in another mode; disarm it first"),
            Choice("UNKNOWN_MODE", 3, "the board does not know this mode"),
            Choice("NOT_ARMED", 4, "the board is not armed for this; arm it first"),
            Choice("ARMED", 5, "the board is armed; disarm it first"),
            Choice("SELF_TEST_FAILED", 6, "the law's self-test fails on this board; flash it again"),
            Choice(
                "POSITION_LOST", 7, "an encoder jumped or stood still; mend it, then PRESET where the plant stands now"
            ),
        ),
    ),
    Enumeration(
        "arithmetic",
        "Arithmetic of the law, and of every number on the line.",
        (Choice("FLOAT32", 0, "float32"), Choice("FIXED", 1, "fixed")),
    ),
    Enumeration(
        "reset_cause",
        "Why the board started.",
        (
            Choice("POWER", 0, "power on or brown-out"),
            Choice("PIN", 1, "reset pin"),
            Choice("SOFTWARE", 2, "software reset"),
            Choice(
                "WATCHDOG", 3, "independent watchdog: a control step did not finish, or the board had stopped safely"
            ),
            Choice("OTHER", 4, "another cause"),
        ),
    ),
)

_CONSTANTS = (
    Constant("WATCH_PERIOD_US", 10_000, "in which host and encoders are watched, whatever the sample period is"),
    Constant("HOST_LOSS_PERIODS", 10, "watch periods without a setpoint from the host after which it counts as lost"),
    Constant("RAMP_PERIODS", 8, "watch periods from the loss of the host to the safe value"),
    Constant("ENCODER_JUMP_COUNTS", 256, "counts in one watch period beyond which an encoder is not believed"),
    Constant(
        "ENCODER_STILL_PERIODS", 100, "watch periods at full drive without a count after which it is not believed"
    ),
    Constant(
        "TELEMETRY_LEAST_US", 2_000, "between two telemetry frames at the least: the line has room for replies too"
    ),
    Constant("BAUD_RATE", 921_600, "of the serial line, 8N1"),
)


@dataclass(frozen=True)
class _LoopFields:
    """What the line carries of each loop."""

    references: tuple[Field, ...]
    angles: tuple[Field, ...]
    inputs: tuple[Field, ...]
    duties: tuple[Field, ...]
    counts: tuple[Field, ...]


def _command(loop: Loop) -> str:
    return "voltage" if loop.input_unit == "V" else "command"


def _fields_of(loops: tuple[Loop, ...]) -> _LoopFields:
    return _LoopFields(
        references=tuple(
            _number(loop.reference, unit_of(loop.output) or "1", f"{loop.axis} reference") for loop in loops
        ),
        angles=tuple(_number(loop.output, unit_of(loop.output) or "1", loop.axis) for loop in loops),
        inputs=tuple(
            _number(
                loop.input,
                unit_of(loop.input) or "1",
                f"{loop.motor} motor {_command(loop)} out of the law, after its limits",
            )
            for loop in loops
        ),
        duties=tuple(
            Field(loop.duty, I16, "PWM ticks", f"signed duty written to the {loop.motor} motor's PWM") for loop in loops
        ),
        counts=tuple(Field(loop.counts, I32, "encoder counts", f"{loop.axis} encoder") for loop in loops),
    )


def _request(name: str, code: int, meaning: str, *fields: Field) -> Message:
    return Message(name, code, True, meaning, fields)


def _to_board(fields: _LoopFields) -> tuple[Message, ...]:
    who = "Who are you? Starts a session: sequence numbers continue from this frame."
    arm = "Arm in a mode; refused unless the table is the expected one. Repeating it changes nothing."
    sample = (
        "One sample in host-in-the-loop mode: exactly one step of the law; a repeated frame is answered from memory."
    )
    self_test = "Ask for the result of the law's self-test, which the board runs once at its start."
    reset = "In host-in-the-loop mode: start the law anew, at rest at these angles."
    return (
        _request("IDENTIFY", 0x01, who),
        _request("ARM", 0x02, arm, *_ARM),
        _request("DISARM", 0x03, "Power stage off at once; obeyed in any state and order."),
        _request(
            "REFERENCE", 0x04, "References while flying; the latest wins, none is acknowledged.", *fields.references
        ),
        _request("SAMPLE", 0x05, sample, *fields.references, *fields.angles),
        _request("GET_COUNTERS", 0x06, "Ask for COUNTERS."),
        _request("SELF_TEST", 0x07, self_test),
        _request("PRESET", 0x08, "Declare what the encoders read now; refused while armed.", *fields.counts),
        _request("RESET_LAW", 0x09, reset, *fields.angles),
    )


def _answer(name: str, code: int, meaning: str, *fields: Field) -> Message:
    return Message(name, code, False, meaning, (*_HEAD, *fields))


def _from_board(fields: _LoopFields) -> tuple[Message, ...]:
    seen = (*fields.counts, *fields.angles, *fields.references, *fields.inputs, *fields.duties)
    outcome = "Outcome of a command, or the reason why a setpoint was not taken."
    every = "Answer to GET_COUNTERS: every frame that was delimited on the line is in exactly one of the first nine."
    return (
        _answer("IDENTITY", 0x81, "Answer to IDENTIFY.", *_IDENTITY),
        _answer("RESULT", 0x82, outcome, *_RESULT),
        _answer("ANSWER", 0x83, "Answer to SAMPLE.", *fields.inputs, *fields.duties, _LAW_CYCLES),
        _answer(
            "TELEMETRY", 0x84, "Sent each tick while flying or ramping.", _TICK, *seen, _LAW_CYCLES, *_TELEMETRY_COUNTS
        ),
        _answer("COUNTERS", 0x85, every, *_COUNTERS),
        _answer("SELF_TEST_RESULT", 0x86, "Answer to SELF_TEST.", _MISMATCHES),
    )


@cache
def protocol_of(loops: tuple[Loop, ...]) -> Protocol:
    """The declaration for a board whose law closes `loops`."""
    fields = _fields_of(loops)
    return Protocol(
        version=1,
        constants=_CONSTANTS,
        enumerations=_ENUMERATIONS,
        messages=_to_board(fields) + _from_board(fields),
        loops=loops,
    )


# The helicopter's; constants, enumerations, and messages without a loop in them are those of any.
PROTOCOL = protocol_of(LOOPS)
