"""The emulated board behind a pseudo-terminal in wall time: any program that opens a serial device can talk to it.

POSIX only. The terminal's own speed setting is the host's speed: a client that opens it with another one gets garbage.
"""

import contextlib
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from records.errors import BadInput
from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.emulator.boot_loader import BootLoader, LoaderFaults
from rig.emulator.image import Image
from rig.emulator.native import library
from rig.emulator.stops import Stop
from rig.emulator.terminal import Terminal

SLICE_S = 0.001  # how long the board may lag behind the wall clock
LONGEST_LEAP_S = 0.05  # after a pause of the computer the board goes on from where it was


class _PtyChip:
    """A chip that runs in a thread of its own; `path` is the device to open. Use it as a context manager."""

    def __init__(self, speed_baud: int, clock: Callable[[], float]) -> None:
        self.stop: Stop | None = None
        self._clock = clock
        self._terminal = Terminal(speed_baud)
        self._speed_baud: int | None = speed_baud
        self.path = self._terminal.path
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="emulated board", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Switch the chip off and remove the device."""
        self._closing.set()
        self._thread.join()
        self._terminal.close()

    def _run(self) -> None:
        raise NotImplementedError

    def _pace(self, board: EmulatedBoard) -> None:
        """Let the board keep up with the wall clock until it stops or is switched off."""
        origin_s = self._clock() - board.time_s
        while not self._closing.is_set() and self.stop is None:
            self._take_from_host(board)
            target_s = self._clock() - origin_s
            leap_s = target_s - board.time_s - LONGEST_LEAP_S
            origin_s += max(0.0, leap_s)
            self._run_to(board, target_s - max(0.0, leap_s))

    def _take_from_host(self, board: EmulatedBoard) -> None:
        data = self._terminal.read(SLICE_S)
        speed_baud = self._terminal.speed_baud
        if speed_baud and speed_baud != self._speed_baud:
            self._speed_baud = speed_baud
            board.set_host_baud(speed_baud)
        if data:
            board.uart_write(data)

    def _run_to(self, board: EmulatedBoard, t_s: float) -> None:
        stop = board.run_until_s(t_s)
        self._terminal.write(board.uart_read())
        if stop.is_fault:
            self.stop = stop


class PtyBoard(_PtyChip):
    """A running board. `stop` tells why it stopped, None while it runs. The board belongs to its thread until `close`."""

    def __init__(
        self,
        elf: bytes | Path | Image,
        config: BoardConfig | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.board = EmulatedBoard(elf, config)
        super().__init__(self.board.config.host_baud, clock)

    def _run(self) -> None:
        self._pace(self.board)


class PtyBootLoader(_PtyChip):
    """A chip in its serial boot loader; sent to the start of a program in flash, it runs that, on the same line.

    `loader` holds the flash; what the host makes of the line's speed, the loader follows as its 0x7F lets it.
    """

    def __init__(
        self, faults: LoaderFaults | None = None, flash: bytes = b"", clock: Callable[[], float] = time.monotonic
    ) -> None:
        library()  # compiled before the line is open: a program that has been started is to answer at once
        self.loader = BootLoader(faults, flash)
        super().__init__(BoardConfig().host_baud, clock)

    def _run(self) -> None:
        while not self._closing.is_set() and self.loader.go_address is None:
            self._terminal.write(self.loader.take(self._terminal.read(SLICE_S)))
        if self.loader.go_address is not None:
            board = EmulatedBoard(Image.from_flash(bytes(self.loader.flash), "flash", self.loader.chip))
            with contextlib.suppress(BadInput):  # a program in RAM is not emulated: the line is silent
                board.start_from_boot_loader(self.loader.go_address)
                self._pace(board)
