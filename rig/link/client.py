"""The host's end of the line to a board: real, emulated or behind a pty, it knows no difference."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from records.errors import BadInput
from records.protocol import PROTOCOL
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
        timeout_s: float = DEFAULT_TIMEOUT_S,
        lines: ModemLines = LEFT_ALONE,
    ) -> Self:
        """Open the port `url` and ask for the identity before anything else.

        Raises BadInput when the port is not there, is silent or noisy, speaks another protocol, or when the board's table is not
        `table_digest` (64 hexadecimal digits; None accepts any table).
        """
        port = open_port(url, timeout_s=timeout_s, lines=lines)
        return cls.over(port, url, table_digest=table_digest, numbers=numbers or Float32Numbers())

    @classmethod
    def over(cls, port: Any, where: str, *, table_digest: str | None, numbers: Numbers) -> Self:
        """As `connect`, over a port that is open; it is closed again when the board is refused."""
        line = Line(port, where, FrameReceiver(PROTOCOL))
        try:
            identity = _introduced(line)
            check_identity(identity, where, table_digest, numbers.name)
        except BaseException:
            port.close()
            raise
        return cls(line, identity, numbers)

    @property
    def numbers(self) -> Numbers:
        """How the board's law writes its numbers."""
        return self._numbers

    def arm(self, mode: str) -> None:
        """Arm in `mode` ("FLYING" or "LOOP"); the board refuses a host whose table is not its own."""
        head = bytes.fromhex(self.identity.table_digest)[:DIGEST_HEAD_BYTES]
        self._command("ARM", {"mode": PROTOCOL.enumeration("mode").code(mode), "digest_head": head})

    def disarm(self) -> None:
        """Power stage off."""
        self._command("DISARM", {})

    def reset_law(self, psi_rad: float, phi_rad: float) -> None:
        """Start the law anew at rest at these angles (host-in-the-loop mode)."""
        self._command("RESET_LAW", self._words("RESET_LAW", psi_rad=psi_rad, phi_rad=phi_rad))

    def sample(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> Answer:
        """One step of the law on these references and angles (host-in-the-loop mode)."""
        words = self._words(
            "SAMPLE", psi_ref_rad=psi_ref_rad, phi_ref_rad=phi_ref_rad, psi_rad=psi_rad, phi_rad=phi_rad
        )
        return replies.answer(self._request("SAMPLE", words, "ANSWER"), self._numbers)

    def reference(self, psi_ref_rad: float, phi_ref_rad: float) -> int:
        """Send references while flying, unacknowledged; returns the number that telemetry will echo."""
        return self._line.send("REFERENCE", self._words("REFERENCE", psi_ref_rad=psi_ref_rad, phi_ref_rad=phi_ref_rad))

    def telemetry(self) -> Telemetry | None:
        """The next telemetry of a flight, or None when the time-out passes without one."""
        frame = self._line.next_frame("TELEMETRY")
        return None if frame is None else replies.telemetry(frame, self._numbers)

    def preset(self, psi_counts: int, phi_counts: int) -> None:
        """Declare what the encoders read at this moment."""
        self._command("PRESET", {"psi_counts": psi_counts, "phi_counts": phi_counts})

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

    def _words(self, name: str, **quantities: float) -> dict[str, Value]:
        units = {part.name: part.unit for part in PROTOCOL.message(name).fields}
        return {key: self._numbers.to_word(value, units[key]) for key, value in quantities.items()}

    def _command(self, name: str, values: Mapping[str, Value]) -> None:
        self._request(name, values, "RESULT")

    def _request(self, name: str, values: Mapping[str, Value], reply_name: str) -> Frame:
        frame = self._line.request(name, values, reply_name)
        if frame.message.name == "RESULT":
            check_result(frame, name, self._line.where)
        return frame


def asked_identity(url: str, *, timeout_s: float = DEFAULT_TIMEOUT_S) -> Identity:
    """Who the board at `url` is, whatever its table and arithmetic; raises BadInput when the port is not there or silent."""
    port = open_port(url, timeout_s=timeout_s)
    try:
        return _introduced(Line(port, url, FrameReceiver(PROTOCOL)))
    finally:
        port.close()


def _introduced(line: Line) -> Identity:
    line.restart()
    identity = replies.identity(line.request("IDENTIFY", {}, "IDENTITY"))
    line.backlog.clear()  # replies to an earlier host, whose numbers would be taken for ours
    return identity


def check_identity(identity: Identity, where: str, table_digest: str | None, arithmetic: str) -> None:
    """Raise BadInput unless protocol, arithmetic and controller table are the expected ones."""
    if identity.schema_hash != PROTOCOL.schema_hash.hex():
        raise BadInput(
            what="protocol",
            where=where,
            got=f"schema {identity.schema_hash}",
            expected=f"schema {PROTOCOL.schema_hash.hex()}",
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
