"""Numbers of the law as the raw 32-bit words that cross the line."""

import struct
from typing import Protocol


class Numbers(Protocol):
    """How one arithmetic of the law writes a quantity of a unit (`rad` or `V`) into a word, and reads it back."""

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
