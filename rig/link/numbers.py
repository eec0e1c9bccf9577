"""Numbers of the law as the raw 32-bit words that cross the line."""

import struct
from typing import Protocol

from codegen.fixed.formats import law_formats, value_of, word_of
from records.law_table import FlownTable
from records.table import ControllerTable


class Numbers(Protocol):
    """How one arithmetic of the law writes what it measures (`rad`) or commands (`V`) into a word, and reads it back."""

    name: str

    def to_word(self, value: float, unit: str) -> int:
        """The word nearest to `value`."""
        ...

    def from_word(self, word: int, unit: str) -> float:
        """The value of `word`, exactly."""
        ...


class Float32Numbers:
    """IEEE 754 binary32, whatever the unit."""

    name = "float32"

    def to_word(self, value: float, unit: str) -> int:
        """The bits of the nearest float32; beyond its range an infinity, as the hardware rounds."""
        try:
            packed = struct.pack("<f", value)
        except OverflowError:
            packed = struct.pack("<f", float("inf") if value > 0 else float("-inf"))
        return int.from_bytes(packed, "little")

    def from_word(self, word: int, unit: str) -> float:
        """The float32 with these bits."""
        (value,) = struct.unpack("<f", word.to_bytes(4, "little"))
        return float(value)


class FixedNumbers:
    """Words of the fixed-point law: a value times 2^places, each unit with its own places; NaN and infinities are MISSING."""

    name = "fixed"

    def __init__(self, angle_places: int, voltage_places: int) -> None:
        self._places = {"rad": angle_places, "V": voltage_places}

    def to_word(self, value: float, unit: str) -> int:
        """The nearest word as 32 bits; beyond its range the outermost one."""
        return word_of(value, self._places[unit]) % 2**32

    def from_word(self, word: int, unit: str) -> float:
        """The value of these 32 bits, NaN for MISSING."""
        return value_of(word - 2**32 if word >= 2**31 else word, self._places[unit])


def numbers_of(table: FlownTable, arithmetic: str) -> Numbers:
    """How the law of `table` in this arithmetic writes its numbers; fixed point is the scheduled law's alone."""
    if arithmetic == "float32" or not isinstance(table, ControllerTable):
        return Float32Numbers()
    formats = law_formats(table)
    return FixedNumbers(formats.angle_places, formats.voltage_places)
