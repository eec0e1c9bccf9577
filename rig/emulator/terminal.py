"""A pseudo-terminal, one end of which is a serial device to any program, the other the line of an emulated chip. POSIX only."""

import contextlib
import os
import select

from records.errors import BadInput

try:
    import termios
    import tty
except ImportError:  # no POSIX: all but these terminals works
    SPEEDS: dict[int, int] = {}
else:
    SPEEDS = {getattr(termios, name): int(name[1:]) for name in dir(termios) if name[0] == "B" and name[1:].isdigit()}
SPEED_CODES = {baud: code for code, baud in SPEEDS.items()}
OUTPUT_SPEED = 5  # index into what tcgetattr gives


class Terminal:
    """The chip's end; `path` is the device that the host opens, and `speed_baud` what the host has set there.

    It carries bytes: no parity, no framing, no time. Raises BadInput on a system without pseudo-terminals.
    """

    def __init__(self, speed_baud: int) -> None:
        if not SPEEDS:
            got, remedy = (
                "a system without pseudo-terminals",
                "use Linux or macOS (Windows: WSL), or a board of your own",
            )
            raise BadInput("emulated chip", "pseudo-terminal", got, "a POSIX system", remedy)
        self._chip, self._device = os.openpty()
        os.set_blocking(self._chip, False)
        tty.setraw(self._device)
        settings = termios.tcgetattr(self._device)
        settings[4] = settings[5] = SPEED_CODES.get(speed_baud, termios.B115200)
        termios.tcsetattr(self._device, termios.TCSANOW, settings)
        self.path = os.ttyname(self._device)

    @property
    def speed_baud(self) -> int | None:
        """None for a speed that the host's own list does not know."""
        return SPEEDS.get(termios.tcgetattr(self._device)[OUTPUT_SPEED])

    def read(self, patience_s: float) -> bytes:
        """What the host has sent, after this time at the latest."""
        ready, _, _ = select.select([self._chip], [], [], patience_s)
        return os.read(self._chip, 4096) if ready else b""

    def write(self, answer: bytes) -> None:
        """As with a real port, what nobody reads is lost when the buffer is full."""
        with contextlib.suppress(BlockingIOError):
            while answer:
                answer = answer[os.write(self._chip, answer) :]

    def close(self) -> None:
        """Remove the device."""
        os.close(self._chip)
        os.close(self._device)
