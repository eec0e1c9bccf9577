"""The firmware's control path on this computer behind a serial port in virtual time: bytes take time, ticks come, hosts are lost."""

from records.protocol import PROTOCOL
from tests.firmware.box import Box

BYTE_S = 10.0 / PROTOCOL.constant("BAUD_RATE")
TICK_S = 0.01


class TimedBox:
    """A port like the emulated one, a hundred times faster; `box` is open to tests. Time passes in writes, reads and waits."""

    def __init__(self) -> None:
        self.box = Box()
        self.timeout: float | None = 0.25
        self.time_s = 0.0
        self.time_outs = 0
        self._ticks = 0
        self._waiting = b""
        self._out = self.box.ffi.new("uint8_t[]", 16_384)

    def write(self, data: bytes) -> int:
        """The board takes the bytes when all of them have passed the line."""
        self.wait(len(data) * BYTE_S)
        for start in range(0, len(data), 32):
            piece = data[start : start + 32]
            count = self.box.lib.box_feed(self.box.path, piece, len(piece), self._now_us, self._out)
            self._waiting += bytes(self.box.ffi.buffer(self._out, count))
        return len(data)

    def read(self, size: int = 1) -> bytes:
        """Up to `size` bytes, when they are there or the time-out has passed."""
        end_s = self.time_s + (self.timeout or 0.0)
        while len(self._waiting) < size and self.time_s < end_s:
            self.wait(min(TICK_S, end_s - self.time_s))
        self.time_outs += len(self._waiting) < size
        self.time_s += min(size, len(self._waiting)) * BYTE_S
        data, self._waiting = self._waiting[:size], self._waiting[size:]
        return data

    def wait(self, duration_s: float) -> None:
        """Let time pass, with the control ticks that fall into it."""
        self.time_s += duration_s
        box = self.box
        while self._ticks < int(self.time_s / TICK_S):
            self._ticks += 1
            count = box.lib.box_tick(box.path, box.psi_counts, box.phi_counts, 1, self._now_us, self._out)
            self._waiting += bytes(box.ffi.buffer(self._out, count))

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""
        return len(self._waiting)

    def reset_input_buffer(self) -> None:
        """Forget what has come."""
        self._waiting = b""

    def close(self) -> None:
        """The host hangs up; the board goes on."""

    @property
    def _now_us(self) -> int:
        return int(self.time_s * 1e6) & 0xFFFFFFFF
