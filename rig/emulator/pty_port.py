"""The emulated board behind a pseudo-terminal in wall time: any program that opens a serial device can talk to it.

POSIX only. The terminal's own speed setting is the host's speed: a client that opens it with another one gets garbage.
"""

import contextlib
import os
import select
import termios
import threading
import time
import tty
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import Stop

SLICE_S = 0.001  # how long the board may lag behind the wall clock
LONGEST_LEAP_S = 0.05  # after a pause of the computer the board goes on from where it was
SPEEDS = {getattr(termios, name): int(name[1:]) for name in dir(termios) if name[0] == "B" and name[1:].isdigit()}
SPEED_CODES = {baud: code for code, baud in SPEEDS.items()}
OUTPUT_SPEED = 5  # index into what tcgetattr gives


class PtyBoard:
    """A running board; `path` is the device to open. Use it as a context manager.

    `stop` tells why the board stopped, None while it runs. The board itself belongs to the pacing thread until `close`.
    """

    def __init__(
        self, elf: bytes | Path, config: BoardConfig | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.board = EmulatedBoard(elf, config)
        self.stop: Stop | None = None
        self._clock = clock
        self._master, self._slave = os.openpty()
        os.set_blocking(self._master, False)
        self._prepare_terminal()
        self.path = os.ttyname(self._slave)
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._pace, name="emulated board", daemon=True)
        self._thread.start()

    def __enter__(self) -> "PtyBoard":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Switch the board off and remove the device."""
        self._closing.set()
        self._thread.join()
        os.close(self._master)
        os.close(self._slave)

    def _prepare_terminal(self) -> None:
        tty.setraw(self._slave)
        settings = termios.tcgetattr(self._slave)
        settings[4] = settings[5] = SPEED_CODES.get(self.board.config.host_baud, termios.B115200)
        termios.tcsetattr(self._slave, termios.TCSANOW, settings)
        self._speed = settings[OUTPUT_SPEED]

    def _pace(self) -> None:
        origin_s = self._clock() - self.board.time_s
        while not self._closing.is_set() and self.stop is None:
            self._take_from_host()
            target_s = self._clock() - origin_s
            leap_s = target_s - self.board.time_s - LONGEST_LEAP_S
            origin_s += max(0.0, leap_s)
            self._run_to(target_s - max(0.0, leap_s))

    def _take_from_host(self) -> None:
        ready, _, _ = select.select([self._master], [], [], SLICE_S)
        self._follow_speed()
        if ready:
            self.board.uart_write(os.read(self._master, 4096))

    def _follow_speed(self) -> None:
        speed = termios.tcgetattr(self._slave)[OUTPUT_SPEED]
        if speed != self._speed and SPEEDS.get(speed):
            self._speed = speed
            self.board.set_host_baud(SPEEDS[speed])

    def _run_to(self, t_s: float) -> None:
        stop = self.board.run_until_s(t_s)
        self._give_to_host(self.board.uart_read())
        if stop.is_fault:
            self.stop = stop

    def _give_to_host(self, answer: bytes) -> None:
        """As with a real port, what nobody reads is lost when the buffer is full."""
        with contextlib.suppress(BlockingIOError):
            while answer:
                answer = answer[os.write(self._master, answer) :]
