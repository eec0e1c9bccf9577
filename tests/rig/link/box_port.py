"""A serial port whose other end is the firmware's control path on this computer; time passes only by read time-outs."""

from collections.abc import Callable

from records.protocol import PROTOCOL
from rig.link.frames import Frame, encode_frame
from tests.firmware.box import Box

Disturb = Callable[[bytes], bytes]


class BoxPort:
    """What the client needs of a serial port; `to_board` and `to_host` may change the bytes of each piece."""

    def __init__(self, to_board: Disturb = bytes, to_host: Disturb = bytes) -> None:
        self.box = Box()
        self.to_board = to_board
        self.to_host = to_host
        self.waiting = b""
        self.closed = False
        self.time_outs = 0
        self.timeout: float | None = 0.25

    def write(self, data: bytes) -> int:
        """The board takes the bytes and answers at once."""
        self._answer(self.box.feed(self.to_board(data)))
        return len(data)

    def tick(self) -> None:
        """One control tick of the board."""
        self._answer(self.box.tick())

    def read(self, count: int) -> bytes:
        """Up to `count` bytes; fewer mean a time-out."""
        data, self.waiting = self.waiting[:count], self.waiting[count:]
        self.time_outs += len(data) < count
        return data

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""
        return len(self.waiting)

    def reset_input_buffer(self) -> None:
        """Forget what has come."""
        self.waiting = b""

    def close(self) -> None:
        """The host hangs up."""
        self.closed = True

    def _answer(self, frames: list[Frame]) -> None:
        for frame in frames:
            self.waiting += self.to_host(again(frame))


def again(frame: Frame) -> bytes:
    """The bytes of a received frame."""

    return encode_frame(PROTOCOL, frame.message.name, frame.sequence, frame.values)
