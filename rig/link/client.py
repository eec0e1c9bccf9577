"""The host's end of the line to a board: real, emulated or behind a pty, it knows no difference."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from records.errors import BadInput
from records.loops import Loop, has_pins
from records.protocol import PROTOCOL
from records.wire import Protocol
from rig.link import replies
from rig.link.frames import Frame, FrameReceiver, Value
from rig.link.line import Line
from rig.link.numbers import Float32Numbers, Numbers
from rig.link.port import LEFT_ALONE, ModemLines, open_port
from rig.link.replies import Answer, Health, Identity, Telemetry

DIGEST_HEAD_BYTES = 8
DEFAULT_TIMEOUT_S = 0.25


class BoardClient:
    """A connected board whose identity has been checked.

    Commands are repeated when a frame is lost, which the board recognises; references are not. Every method raises BadInput
    when the board does not answer or refuses.
    """

    def __init__(self, line: Line, identity: Identity, numbers: Numbers) -> None:
        self._line = line
        self._numbers = numbers
        self.identity = identity

    @classmethod
    def connect(
        cls,
        url: str,
        *,
        table_digest: str | None = None,
        numbers: Numbers | None = None,
        protocol: Protocol = PROTOCOL,
        timeout_s: float = DEFAULT_TIMEOUT_S,
        lines: ModemLines = LEFT_ALONE,
    ) -> Self:
        """Open the port `url` and ask for the identity before anything else; `protocol` is that of the table's loops.

        Raises BadInput when the port is not there, is silent or noisy, speaks another protocol, or when the board's table is not
        `table_digest` (64 hexadecimal digits; None accepts any table).
        """
        port = open_port(url, timeout_s=timeout_s, lines=lines)
        return cls.over(port, url, table_digest=table_digest, numbers=numbers or Float32Numbers(), protocol=protocol)

    @classmethod
    def over(
        cls, port: Any, where: str, *, table_digest: str | None, numbers: Numbers, protocol: Protocol = PROTOCOL
    ) -> Self:
        """As `connect`, over a port that is open; it is closed again when the board is refused."""
        line = Line(port, where, FrameReceiver(protocol))
        try:
            identity = _introduced(line)
            check_identity(identity, where, table_digest, numbers.name, protocol)
        except BaseException:
            port.close()
            raise
        return cls(line, identity, numbers)

    @property
    def numbers(self) -> Numbers:
        """How the board's law writes its numbers."""
        return self._numbers

    @property
    def loops(self) -> tuple[Loop, ...]:
        """The loops that the board's law closes, in the order of every list of angles and voltages."""
        return self._line.protocol.loops

    def arm(self, mode: str) -> None:
        """Arm in `mode` ("FLYING" or "LOOP"); the board refuses a host whose table is not its own.

        FLYING is on the board's own sensors: refused, before the board is asked, for loops without pins.
        """
        if mode == "FLYING":
            demand_pins(self.loops, self._line.where)
        head = bytes.fromhex(self.identity.table_digest)[:DIGEST_HEAD_BYTES]
        self._command("ARM", {"mode": PROTOCOL.enumeration("mode").code(mode), "digest_head": head})

    def disarm(self) -> None:
        """Power stage off."""
        self._command("DISARM", {})

    def reset_law(self, *angles_rad: float) -> None:
        """Start the law anew at rest at these angles, one a loop (host-in-the-loop mode)."""
        self._command("RESET_LAW", self._words("RESET_LAW", angles_rad))

    def sample(self, *given_rad: float) -> Answer:
        """One step of the law on the references, then the angles, of all loops (host-in-the-loop mode)."""
        frame = self._request("SAMPLE", self._words("SAMPLE", given_rad), "ANSWER")
        return replies.answer(frame, self._numbers, self.loops)

    def reference(self, *references_rad: float) -> int:
        """Send references, one a loop, while flying, unacknowledged; returns the number that telemetry will echo."""
        return self._line.send("REFERENCE", self._words("REFERENCE", references_rad))

    def telemetry(self) -> Telemetry | None:
        """The next telemetry of a flight, or None when the time-out passes without one."""
        frame = self._line.next_frame("TELEMETRY")
        return None if frame is None else replies.telemetry(frame, self._numbers, self.loops)

    def preset(self, *counts: int) -> None:
        """Declare what the encoders, one a loop, read at this moment."""
        self._command("PRESET", {loop.counts: count for loop, count in zip(self.loops, counts, strict=True)})

    def counters(self) -> Mapping[str, int]:
        """The board's counters by name."""
        return self.health().counters

    def health(self) -> Health:
        """The board's state and counters, and what this end of the line has received."""
        return replies.health(self._request("GET_COUNTERS", {}, "COUNTERS"), self._line.receiver.received)

    def self_test(self) -> int:
        """Outputs of the law's self-test on the board that differ from the expected bits; 0 is a pass."""
        return self._request("SELF_TEST", {}, "SELF_TEST_RESULT").number("mismatches")

    def clock_s(self) -> float:
        """The time that the line lives in: of a port whose time is virtual, that, else the computer's."""
        return float(getattr(self._line.port, "time_s", None) or time.perf_counter())

    def close(self) -> None:
        """Close the port; a board that is still armed loses its host and ramps to the safe value."""
        self._line.port.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _words(self, name: str, quantities: tuple[float, ...]) -> dict[str, Value]:
        """The fields of a message, all of them references or measurements of the law, in their declared order."""
        fields = self._line.protocol.message(name).fields
        return {part.name: self._numbers.to_word(value, "rad") for part, value in zip(fields, quantities, strict=True)}

    def _command(self, name: str, values: Mapping[str, Value]) -> None:
        self._request(name, values, "RESULT")

    def _request(self, name: str, values: Mapping[str, Value], reply_name: str) -> Frame:
        frame = self._line.request(name, values, reply_name)
        if frame.message.name == "RESULT":
            check_result(frame, name, self._line.where)
        return frame


def asked_identity(url: str) -> Identity:
    """Who the board at `url` is, whatever its table and arithmetic; raises BadInput when the port is not there or silent."""
    port = open_port(url, timeout_s=DEFAULT_TIMEOUT_S)
    try:
        return _introduced(Line(port, url, FrameReceiver(PROTOCOL)))
    finally:
        port.close()


def _introduced(line: Line) -> Identity:
    line.restart()
    identity = replies.identity(line.request("IDENTIFY", {}, "IDENTITY"))
    line.backlog.clear()  # replies to an earlier host, whose numbers would be taken for ours
    return identity


def check_identity(
    identity: Identity, where: str, table_digest: str | None, arithmetic: str, protocol: Protocol = PROTOCOL
) -> None:
    """Raise BadInput unless protocol, arithmetic and controller table are the expected ones."""
    if identity.schema_hash != protocol.schema_hash.hex():
        raise BadInput(
            what="protocol",
            where=where,
            got=f"schema {identity.schema_hash}",
            expected=f"schema {protocol.schema_hash.hex()}",
            remedy="make its image anew with `twinlaw build`, then `twinlaw flash` if it is a real board",
        )
    if identity.arithmetic != arithmetic:
        raise BadInput(
            what="arithmetic",
            where=where,
            got=identity.arithmetic,
            expected=arithmetic,
            remedy="flash an image of that arithmetic, or choose the board's with --arithmetic",
        )
    if table_digest is not None and identity.table_digest != table_digest:
        raise BadInput(
            what="controller table",
            where=where,
            got=f"digest {identity.table_digest[:16]}",
            expected=f"digest {table_digest[:16]}",
            remedy="flash the image of this table with `twinlaw flash`, or give the table that the board carries",
        )


def demand_pins(loops: tuple[Loop, ...], where: str) -> None:
    """Raise BadInput for loops that fly with the host in the loop alone, as the board has no pins for them."""
    if not has_pins(loops):
        names = ", ".join(loop.axis for loop in loops)
        expected = (
            "a sensor and an output on the board for every loop, as section [board] of a plant file names their pins"
        )
        remedy = "fly with the host in the loop: the host sends angles, the board answers voltages"
        raise BadInput("flight on the board's own sensors", where, f"the loops {names}", expected, remedy)


@dataclass(eq=False)
class Refused(BadInput):
    """The board took the command and does not obey; `reason` is its name in the protocol."""

    reason: str = ""


def check_result(frame: Frame, command: str, where: str) -> None:
    """Raise Refused, with the board's own reason, unless a RESULT says that the command was done."""
    reasons = PROTOCOL.enumeration("reason")
    reason = frame.number("reason")
    if reason != reasons.code("DONE"):
        state = PROTOCOL.enumeration("state").sentence(frame.number("state"))
        raise Refused(
            what=command,
            where=where,
            got=f"a refusal ({state})",
            expected="the board to obey",
            remedy=reasons.sentence(reason),
            reason=reasons.name_of(reason),
        )
