"""Opening a serial port by its URL: a device, a pty, or an emulated board, which are all the same to the client."""

import os
from typing import Any

import serial

from records.errors import BadInput
from records.protocol import PROTOCOL
from rig.emulator.ports.serial_port import register_emulated_ports


def open_port(url: str, *, timeout_s: float) -> Any:
    """Open the port `url` (a device path, or a pyserial URL such as emulated://PATH_TO_ELF) at the protocol's baud rate, 8N1.

    Raises BadInput when it is not there or cannot be opened.
    """
    register_emulated_ports()
    try:
        return serial.serial_for_url(url, baudrate=PROTOCOL.constant("BAUD_RATE"), timeout=timeout_s)
    except (OSError, ValueError) as error:
        if isinstance(error.__cause__, BadInput):
            raise error.__cause__ from error  # an emulated board knows better what is wrong
        raise BadInput(
            what="serial port",
            where=url,
            got=_reason(error),
            expected="a port that can be opened",
            remedy="check the cable, the name given as --port, and that you may read and write it",
        ) from error


def _reason(error: OSError | ValueError) -> str:
    """What the system says of it, once; pyserial says it twice, with the port's name in between."""
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)
    return " ".join(str(error).split()) or type(error).__name__
