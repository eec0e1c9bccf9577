"""Opening a serial port by its URL: a device, a pty, or an emulated board, which are all the same to the client."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import serial

from records.errors import BadInput
from records.protocol import PROTOCOL
from rig.emulator.serial_port import register_emulated_ports

_OUTPUT_SPEED = 5  # of what termios tells
# What a lock and a driver answer where a port is open already.
_IN_USE = {errno.EAGAIN, errno.EBUSY}


@dataclass(frozen=True)
class ModemLines:
    """Whether DTR and RTS are set or cleared when a port is opened; None leaves one as the system makes it.

    Boards that hang a reset or a boot pin on one of them start anew, or not at all, where it is touched.
    """

    dtr: bool | None = None
    rts: bool | None = None


LEFT_ALONE = ModemLines()


def open_port(url: str, *, timeout_s: float, lines: ModemLines = LEFT_ALONE) -> Any:
    """Open the port `url` (a device path, or a pyserial URL such as emulated://PATH_TO_ELF) at the protocol's baud rate, 8N1.

    Nobody else who asks for the port has it meanwhile. Raises BadInput when it is not there, in use, or cannot be opened.
    """
    register_emulated_ports()
    try:
        rate = PROTOCOL.constant("BAUD_RATE")
        port = serial.serial_for_url(url, do_not_open=True, baudrate=rate, timeout=timeout_s, exclusive=True)
        _ask(port, lines)
        port.open()
        _demand_rate(port, url, rate)
        return port
    except (OSError, ValueError) as error:
        if isinstance(error.__cause__, BadInput):
            raise error.__cause__ from error  # an emulated board knows better what is wrong
        if isinstance(error, OSError) and error.errno in _IN_USE:
            raise _in_use(url) from error
        raise BadInput(
            what="serial port",
            where=url,
            got=_reason(error),
            expected="a port that can be opened",
            remedy="check the cable, the name given as --port, and that you may read and write it",
        ) from error


@contextmanager
def claimed(device: str) -> Iterator[None]:
    """Keep a device from all others who ask, while a program of another hand uses it; raises BadInput where somebody has it.

    What is no device, or cannot be opened, is left to that program to tell.
    """
    try:
        import fcntl

        handle = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except (ImportError, OSError) as error:
        if isinstance(error, OSError) and error.errno in _IN_USE:
            raise _in_use(device) from error
        yield
        return
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError as error:
        raise _in_use(device) from error
    finally:
        os.close(handle)


def _ask(port: Any, lines: ModemLines) -> None:
    """pyserial sets both lines of every port that it opens; it is kept from those that nobody asked for."""
    if lines.dtr is None:
        port._update_dtr_state = _untouched
    else:
        port.dtr = lines.dtr
    if lines.rts is None:
        port._update_rts_state = _untouched
    else:
        port.rts = lines.rts


def _demand_rate(port: Any, url: str, rate: int) -> None:
    """Raise BadInput where the driver took another speed than asked for: one that has not got it takes the nearest without a word."""
    try:
        import termios

        asked, took = getattr(termios, f"B{rate}"), termios.tcgetattr(port.fileno())[_OUTPUT_SPEED]
    except (ImportError, AttributeError, OSError, termios.error):
        return  # an emulated board, or a system that has no such speeds
    if took == asked:
        return
    port.close()
    names = (name[1:] for name in dir(termios) if name[1:].isdigit() and getattr(termios, name) == took)
    raise BadInput(
        what="serial port",
        where=url,
        got=f"an adapter that runs at {next(names, 'another speed')} baud",
        expected=f"{rate} baud",
        remedy="use an adapter whose driver has that speed: an ST-LINK's own port, FT232, CP2102 or CH340",
    )


def _untouched() -> None:
    """In place of a call that would set a line."""


def _in_use(where: str) -> BadInput:
    return BadInput(
        what="serial port",
        where=where,
        got="a port in use by another program",
        expected="one that nobody else has open",
        remedy="end the other `twinlaw validate`, `watch` or `flash`, or the terminal program, and try again",
    )


def _reason(error: OSError | ValueError) -> str:
    """What the system says of it, once; pyserial says it twice, with the port's name in between."""
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)
    if error.__context__ is not None and errno.ENOTTY in error.__context__.args:
        return "a file or device that is no serial line"
    return " ".join(str(error).split()) or type(error).__name__
