"""What tests do to an emulated board or ask of it, and no stage of the product needs: by the C of the simulator itself."""

from collections.abc import Sequence
from dataclasses import dataclass

from rig.emulator.board import PS_PER_S, EmulatedBoard
from rig.emulator.native import library

EXCEPTIONS = 48


@dataclass(frozen=True)
class ReceivedByte:
    """A byte that has completely left the board, with the end of its stop bit."""

    value: int
    end_s: float
    framing_error: bool
    noise: bool


def received_bytes(board: EmulatedBoard) -> list[ReceivedByte]:
    """Bytes that have completely left the board."""
    (ffi, lib), machine = library(board.config.chip), board.native[1]
    count = board.uart_waiting()
    values, ends_ps, errors = (ffi.new(f"{kind}[]", count) for kind in ("uint8_t", "uint64_t", "uint8_t"))
    lib.emulator_receive(machine, values, ends_ps, errors, count)
    rows = zip(values, ends_ps, errors, strict=True)
    return [ReceivedByte(value, end / PS_PER_S, bool(error & 1), bool(error & 2)) for value, end, error in rows]


def exception_counts(board: EmulatedBoard) -> dict[int, int]:
    """How often each exception number was taken (16 + n is interrupt n)."""
    (ffi, lib), machine = library(board.config.chip), board.native[1]
    counts = ffi.new("uint64_t[]", EXCEPTIONS)
    lib.emulator_exception_counts(machine, counts)
    return {number: int(counts[number]) for number in range(EXCEPTIONS) if counts[number]}


def silence_converter(board: EmulatedBoard) -> None:
    """Break the converter: no conversion ends from now on."""
    lib, machine = board.native
    lib.emulator_silence_converter(machine)


def drive_pin(board: EmulatedBoard, port: str, pin: int, level: bool) -> None:
    """Put a level on an input pin from outside."""
    lib, machine = board.native
    lib.emulator_drive_pins(machine, "ABC".index(port), 1 << pin, int(level) << pin)


def set_registers(board: EmulatedBoard, values: Sequence[int]) -> None:
    """Set r0-r15 and the flags (bits 31:28 of the 17th value)."""
    lib, machine = board.native
    lib.emulator_set_registers(machine, list(values))
