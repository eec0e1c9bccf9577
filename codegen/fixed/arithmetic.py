"""Words of the fixed-point law: what the law asks of them, as Python integers, and as lanes of int64, which give what the C gives."""

from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.formats import MISSING

Lanes = NDArray[np.int64]
N = TypeVar("N")

_LOW_WORD = 2**32 - 1
_LOW_HALF = 2**16 - 1


class Words(Protocol[N]):
    """What the law asks of its numbers beyond + - * of words and of powers of two."""

    def word(self, name: str, value: N) -> N:
        """`value`, which is stored in 32 bits under this name."""

    def floored(self, value: N, places: int) -> N:
        """floor(value / 2^places)."""

    def clamp(self, value: N, low: N, high: N) -> N:
        """`value` held within low..high; its differences to both must fit a word."""

    def accepted(self, value: N, last: N) -> N:
        """`value` unless it is MISSING, else `last`."""

    def held(self, value: N, low: N, high: N) -> N:
        """`value`, any word, held within low..high, where low <= 0 <= high."""

    def towards(self, value: N, target: N, gain: N) -> N:
        """value + gain (target - value), gain with 31 places, the step rounded away from zero: it never stops short."""

    def whole(self, total: N, places: int) -> tuple[Any, N]:
        """Whether floor(total / 2^places) lies within -2^30..2^30 - 1, and then that number, else zero."""

    def fraction(self, value: N, places: int) -> N:
        """value modulo 2^places."""

    def is_within(self, value: N, bits: int) -> Any:
        """Condition -2^bits <= value < 2^bits."""

    def both(self, one: Any, other: Any) -> Any:
        """Condition that both hold."""

    def choose(self, condition: Any, value: N, otherwise: N) -> N:
        """`value` where the condition holds, else `otherwise`."""

    def wrapped(self, value: N, bits: int) -> N:
        """`value` modulo 2^(bits + 1), within -2^bits..2^bits - 1."""

    def scaled(self, value: N, x: N) -> N:
        """value x / 2^32 without the product of the low halves and each half product floored: 0 to 3 below the exact one."""

    def narrow_product(self, value: N, x: N) -> N:
        """value x, where the sum of the middle half products fits one word."""

    def short_product(self, value: N, x: N) -> N:
        """value x of a value of 16 bits."""

    def scaled_short(self, value: N, x: N) -> N:
        """floor(value x / 2^16) of a value of 16 bits."""


class Scalars:
    """The law's decisions on single integers."""

    def word(self, name: str, value: int) -> int:
        return value

    def floored(self, value: int, places: int) -> int:
        return value >> places

    def clamp(self, value: int, low: int, high: int) -> int:
        return low if value < low else high if high < value else value

    def accepted(self, value: int, last: int) -> int:
        return last if value == MISSING else value

    def held(self, value: int, low: int, high: int) -> int:
        return self.clamp(value, low, high)

    def towards(self, value: int, target: int, gain: int) -> int:
        product = gain * (2 * (target - value))
        below = 1 if product > 0 and product & _LOW_WORD else 0
        return value + (product >> 32) + below

    def whole(self, total: int, places: int) -> tuple[bool, int]:
        fits = self.is_within(total >> places, 30)
        return fits, total >> places if fits else 0

    def both(self, one: bool, other: bool) -> bool:
        return one and other

    def fraction(self, value: int, places: int) -> int:
        return value & ((1 << places) - 1)

    def is_within(self, value: int, bits: int) -> bool:
        return -(1 << bits) <= value < 1 << bits

    def choose(self, condition: bool, value: int, otherwise: int) -> int:
        return value if condition else otherwise

    def wrapped(self, value: int, bits: int) -> int:
        return ((value + (1 << bits)) & ((2 << bits) - 1)) - (1 << bits)

    def scaled(self, value: int, x: int) -> int:
        return int(_scaled(value, x))

    def narrow_product(self, value: int, x: int) -> int:
        return value * x

    def short_product(self, value: int, x: int) -> int:
        return value * x

    def scaled_short(self, value: int, x: int) -> int:
        return (value * x) >> 16


class LaneWords:
    """The same decisions on arrays of int64, one lane each."""

    def word(self, name: str, value: Lanes) -> Lanes:
        return value

    def floored(self, value: Lanes, places: int) -> Lanes:
        return value >> places

    def clamp(self, value: Any, low: Any, high: Any) -> Any:
        return np.minimum(np.maximum(value, low), high)

    def accepted(self, value: Any, last: Any) -> Any:
        return np.where(value == MISSING, last, value)

    def held(self, value: Any, low: Any, high: Any) -> Any:
        return self.clamp(value, low, high)

    def towards(self, value: Any, target: Any, gain: Any) -> Any:
        product = gain * (2 * (target - value))
        below = (product > 0) & ((product & _LOW_WORD) != 0)
        return value + (product >> 32) + below

    def whole(self, total: Any, places: int) -> tuple[Any, Any]:
        fits = self.is_within(total >> places, 30)
        return fits, np.where(fits, total >> places, 0)

    def both(self, one: Any, other: Any) -> Any:
        return one & other

    def fraction(self, value: Any, places: int) -> Any:
        return value & (2**places - 1)

    def is_within(self, value: Any, bits: int) -> Any:
        return (value >= -(2**bits)) & (value < 2**bits)

    def choose(self, condition: Any, value: Any, otherwise: Any) -> Any:
        return np.where(condition, value, otherwise)

    def wrapped(self, value: Any, bits: int) -> Any:
        return ((value + 2**bits) & (2 ** (bits + 1) - 1)) - 2**bits

    def scaled(self, value: Any, x: Any) -> Any:
        return _scaled(value, x)

    def narrow_product(self, value: Any, x: Any) -> Any:
        return value * x

    def short_product(self, value: Any, x: Any) -> Any:
        return value * x

    def scaled_short(self, value: Any, x: Any) -> Any:
        return (value * x) >> 16


def _scaled(value: Any, x: Any) -> Any:
    """value x / 2^32 from three products of half words."""
    value_high, x_high = value >> 16, x >> 16
    return value_high * x_high + ((value_high * (x & _LOW_HALF)) >> 16) + (((value & _LOW_HALF) * x_high) >> 16)
