"""The emulated board as a pyserial port in virtual time: `emulated://PATH_TO_ELF`.

Time passes on the board only while the host reads, writes, flushes or looks. A read with a timeout of T waits T virtual
seconds at most; a write lasts as long as its bytes take on the line at the port's baud rate.
"""

from pathlib import Path
from typing import Any

import serial

from records.errors import BadInput
from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard

SCHEME = "emulated://"
FRAME_BITS = 10
PATIENCE_S = 1.0  # a read without timeout goes on in slices of this length


def register_emulated_ports() -> None:
    """Make `serial.serial_for_url("emulated://PATH")` known to pyserial; calling it again changes nothing."""
    if "rig.emulator" not in serial.protocol_handler_packages:
        serial.protocol_handler_packages.append("rig.emulator")


class EmulatedSerial(serial.SerialBase):  # type: ignore[misc]
    """A serial port whose other end is an emulated board; `board` is open to tests and to the flight's encoders.

    Raises serial.SerialException where a device would: no such image, port closed, board stopped by a fault.
    """

    is_open: bool

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.board: EmulatedBoard | None = None
        super().__init__(*args, **kwargs)

    def open(self) -> None:
        """Power up a fresh board with the image that the port's URL names."""
        if self.is_open:
            raise serial.SerialException("port is already open")
        path = Path(str(self._port).removeprefix(SCHEME))
        try:
            self.board = EmulatedBoard(path, BoardConfig(host_baud=self._baudrate))
        except BadInput as error:
            raise serial.SerialException(str(error)) from error
        self.is_open = True
        self._reconfigure_port()

    def close(self) -> None:
        """Switch the board off."""
        self.board = None
        self.is_open = False

    def _reconfigure_port(self) -> None:
        if (self._bytesize, self._parity, self._stopbits) != (8, serial.PARITY_NONE, 1):
            raise ValueError("an emulated port knows 8 data bits, no parity, 1 stop bit only")
        self._powered().set_host_baud(self._baudrate)

    def _powered(self) -> EmulatedBoard:
        if self.board is None:
            raise serial.PortNotOpenError()
        return self.board

    def _run_until(self, count: int, t_s: float) -> None:
        stop = self._powered().run_until_bytes(count, t_s)
        if stop.is_fault:
            raise serial.SerialException(f"emulated board stopped: {stop}")

    @property
    def time_s(self) -> float:
        """Virtual time since the board was powered up."""
        return self._powered().time_s

    def wait(self, duration_s: float) -> None:
        """Let virtual time pass."""
        self._run_until(2**32, self.time_s + duration_s)

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once; looking costs the time of one byte, so that polling loops end."""
        board = self._powered()
        self._run_until(board.uart_waiting() + 1, board.time_s + FRAME_BITS / self._baudrate)
        return board.uart_waiting()

    def read(self, size: int = 1) -> bytes:
        """Up to `size` bytes: returns when they are there, or when the timeout has passed on the board's clock."""
        board = self._powered()
        if self._timeout is None:
            while board.uart_waiting() < size:
                self._run_until(size, board.time_s + PATIENCE_S)
        elif self._timeout == 0:
            size = min(size, self.in_waiting)
        else:
            self._run_until(size, board.time_s + self._timeout)
        return board.uart_read(size)

    def write(self, data: Any) -> int:
        """Send bytes to the board; the board runs on until the last has passed the line."""
        content = serial.to_bytes(data)
        self._powered().uart_write(content)
        self.flush()
        return len(content)

    def flush(self) -> None:
        """Wait until all bytes written have passed the line."""
        self._run_until(2**32, self._powered().uart_line_free_s())

    def reset_input_buffer(self) -> None:
        """Drop what has been received and not read."""
        self._powered().uart_read()

    def reset_output_buffer(self) -> None:
        """Nothing waits for the line: `write` returns when it is free."""
        self._powered()

    def _update_rts_state(self) -> None:
        """The line has no modem signals."""

    def _update_dtr_state(self) -> None:
        """The line has no modem signals."""

    def _update_break_state(self) -> None:
        raise serial.SerialException("an emulated port sends no break")
