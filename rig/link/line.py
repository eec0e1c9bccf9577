"""Requests and replies over one serial line; it knows frames and time-outs, not what they mean."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from records.errors import BadInput
from records.wire import Protocol
from rig.link.frames import DELIMITER, Frame, FrameReceiver, Received, Value, encode_frame, line_length

# Three attempts in time for the board, which counts its host as lost after 100 ms; then with the port's own patience, for
# a board that is still starting or a computer that is busy.
QUICK_S = (0.02, 0.04)
PATIENT_ATTEMPTS = 3
# A line that is never silent would never time out; so many bytes without the reply are as good as silence.
PATIENCE_BYTES = 4096
# Ten seconds of telemetry that came while replies were awaited; the oldest goes first.
BACKLOG_FRAMES = 1000


@dataclass
class Line:
    """One end of the serial line: the port, its name for messages, and the number of the next frame."""

    port: Any
    where: str
    receiver: FrameReceiver
    sequence: int = 0
    backlog: deque[Frame] = field(default_factory=lambda: deque(maxlen=BACKLOG_FRAMES))
    timeout_s: float | None = field(init=False)

    def __post_init__(self) -> None:
        self.timeout_s = self.port.timeout

    @property
    def protocol(self) -> Protocol:
        """What is spoken on the line."""
        return self.receiver.protocol

    def send(self, name: str, values: Mapping[str, Value]) -> int:
        """Send message `name` once and return its sequence number."""
        sequence = self.sequence
        self._write(encode_frame(self.protocol, name, sequence, values))
        self.sequence = (sequence + 1) & 0xFFFF
        return sequence

    def request(self, name: str, values: Mapping[str, Value], reply_name: str) -> Frame:
        """Send message `name` and return the reply to it: `reply_name`, or a RESULT that refuses it.

        A lost frame is sent again under the same number, which the board recognises. Raises BadInput when no reply comes.
        """
        sequence = self.sequence
        line = encode_frame(self.protocol, name, sequence, values)
        self.sequence = (sequence + 1) & 0xFFFF
        expected_bytes = line_length(self.protocol.message(reply_name))
        self._drain()
        before = self.receiver.received
        for attempt, (wait_s, patience_bytes) in enumerate(self._patience(expected_bytes)):
            # A delimiter first ends whatever a disturbance has left in the board's receiver.
            self._write(DELIMITER + line if attempt else line)
            self.port.timeout = wait_s
            reply = self._await({reply_name, "RESULT"}, sequence, expected_bytes, patience_bytes)
            self.port.timeout = self.timeout_s
            if reply is not None:
                return reply
            if self._waiting() == 0:  # what a disturbance has left half would spoil the next reply too
                self.receiver.pending.clear()
        raise no_reply(self.where, name, before, self.receiver.received)

    def next_frame(self, name: str) -> Frame | None:
        """The next frame called `name`, or None when the port's time-out passes without one."""
        return self._await({name}, None, line_length(self.protocol.message(name)), PATIENCE_BYTES)

    def restart(self) -> None:
        """Forget what was received so far, and end whatever the board has received so far."""
        self.port.reset_input_buffer()
        self.receiver.pending.clear()
        self.backlog.clear()
        self._write(DELIMITER)

    def _patience(self, expected_bytes: int) -> list[tuple[float | None, int]]:
        """Time-out and most bytes of each attempt; telemetry comes every 10 ms, so that a stream of it never times out."""
        quick_bytes = expected_bytes + 2 * line_length(self.protocol.message("TELEMETRY"))
        quick = [(wait_s, quick_bytes) for wait_s in QUICK_S if self.timeout_s is None or wait_s < self.timeout_s]
        return [*quick, *[(self.timeout_s, PATIENCE_BYTES)] * PATIENT_ATTEMPTS]

    def _drain(self) -> None:
        """Take in what came before; of that only telemetry is still of use, a reply in it answers something else."""
        waiting = self._waiting()
        if waiting:
            self.backlog.extend(self.receiver.feed(self._read(waiting)))
        for frame in [frame for frame in self.backlog if frame.message.name != "TELEMETRY"]:
            self.backlog.remove(frame)

    def _await(self, names: set[str], echo: int | None, expected_bytes: int, patience_bytes: int) -> Frame | None:
        limit = self.receiver.received.bytes + patience_bytes
        frame = self._take(names, echo)
        while frame is None and self.receiver.received.bytes < limit:
            data = self._read(max(1, expected_bytes - len(self.receiver.pending)))
            if not data:
                return None
            self.backlog.extend(self.receiver.feed(data))
            frame = self._take(names, echo)
        return frame

    def _take(self, names: set[str], echo: int | None) -> Frame | None:
        for frame in self.backlog:
            if frame.message.name in names and echo in (None, frame.values["echo_sequence"]):
                self.backlog.remove(frame)
                return frame
        return None

    def _write(self, data: bytes) -> None:
        try:
            self.port.write(data)
        except OSError as error:
            raise self._broken(error) from error

    def _waiting(self) -> int:
        try:
            return int(self.port.in_waiting)
        except OSError as error:
            raise self._broken(error) from error

    def _read(self, count: int) -> bytes:
        try:
            return bytes(self.port.read(count))
        except OSError as error:
            raise self._broken(error) from error

    def _broken(self, error: OSError) -> BadInput:
        return BadInput(
            what="serial port",
            where=self.where,
            got=" ".join(str(error).split()) or type(error).__name__,
            expected="a port that stays open",
            remedy="check the cable and the board's supply",
        )


def no_reply(where: str, request: str, before: Received, after: Received) -> BadInput:
    """What a missing reply says about the other end: silence, noise, another protocol, or a deaf board."""
    received = after.bytes - before.bytes
    if received == 0:
        got, remedy = (
            "no answer",
            "check the board's supply and cable, press its reset button, flash it with `twinlaw flash`",
        )
    elif after.foreign > before.foreign:
        got, remedy = "frames of another protocol", "make its image anew with `twinlaw build`, then `twinlaw flash`"
    elif after.frames == before.frames:
        got = f"noise ({received} bytes without one sound frame)"
        remedy = "check that this is the board's port, its ground wire and its baud rate"
    else:
        got, remedy = "frames, but no reply to this one", "reset the board and try again"
    return BadInput(
        what=f"reply to {request}", where=where, got=got, expected="a board with twinlaw's firmware", remedy=remedy
    )
