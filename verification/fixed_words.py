"""Words of the fixed-point law that carry a proved enclosure of the real number they stand for and of their deviation from it.

As in affine.py, a tracked word is a ball X with x in X, the real value times 2^places, and an error form D = d + sum_k c_k eps_k
with |eps_k| <= 1, so that the word is x + D. Sums and products are exact; a floor takes off between 0 and 1, that is 1/2 +- 1/2.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Protocol, TypeVar

from flint import arb

from codegen.fixed.arithmetic import Words
from verification.affine import combined, size_of, upper_bound

W = TypeVar("W")

# The symbol of an error form that is no unknown: its eps is 1.
_KNOWN = -1


@dataclass(frozen=True)
class TrackedWord:
    """Enclosure `value` of the real number in steps of the word, error coefficient of each eps in `errors`."""

    value: arb
    errors: Mapping[int, arb]
    symbols: Iterator[int] = field(repr=False, compare=False)

    def __add__(self, other: "TrackedWord | int") -> "TrackedWord":
        if isinstance(other, int):  # what the law adds to a word before it rounds: no part of the real law
            return self.lost(arb(-other), arb(0))
        return replace(self, value=self.value + other.value, errors=combined(self.errors, 1, other.errors, 1))

    def __sub__(self, other: "TrackedWord") -> "TrackedWord":
        return replace(self, value=self.value - other.value, errors=combined(self.errors, 1, other.errors, -1))

    def __mul__(self, other: "TrackedWord | int") -> "TrackedWord":
        if isinstance(other, int):
            return self.times(arb(other))
        errors = combined(self.errors, other.value, other.errors, self.value)
        product = replace(self, value=self.value * other.value, errors=errors)
        second_order = arb(self.error) * arb(other.error)
        return product.lost(arb(0), second_order) if second_order != 0 else product

    def times(self, factor: arb) -> "TrackedWord":
        """The number in other steps."""
        return replace(self, value=self.value * factor, errors={k: c * factor for k, c in self.errors.items()})

    def lost(self, known: arb, unknown: arb) -> "TrackedWord":
        """The word less known +- unknown, its real value unchanged."""
        errors = combined(self.errors, 1, {_KNOWN: -known}, 1)
        if unknown != 0:
            errors[next(self.symbols)] = unknown
        return replace(self, errors=errors)

    @property
    def error(self) -> float:
        """Upper bound of |word - real number| in steps of the word."""
        return size_of(self.errors)


class ErrorWords(Words[W], Protocol[W]):
    """Words of which a proof tells how far they are from real numbers."""

    def constant(self, value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> W:
        """A number of the table: real as the table states it, with terms left out of it; the word is the nearest."""

    def within(self, low: float, high: float) -> W:
        """Any word of low..high, the same in both laws."""

    def restricted(self, number: W, low: float, high: float) -> W:
        """The number where its real value is within low..high."""


class TrackedWords:
    """The law's decisions on tracked words, of which only those within declared ranges occur."""

    def __init__(self) -> None:
        self._symbols = count()

    def constant(self, value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> TrackedWord:
        steps = arb(value) * arb(2) ** places
        word = round(value * 2.0**places + made_up)
        real = steps + arb(0, neglected * 2.0**places) if neglected else steps
        left_out = {next(self._symbols): arb(neglected * 2.0**places)} if neglected else {}
        return TrackedWord(real, {_KNOWN: arb(word) - steps, **left_out}, self._symbols)

    def within(self, low: float, high: float) -> TrackedWord:
        return TrackedWord(arb(low).union(arb(high)), {}, self._symbols)

    def restricted(self, number: TrackedWord, low: float, high: float) -> TrackedWord:
        return replace(number, value=number.value.max(arb(low)).min(arb(high)))

    def word(self, name: str, value: TrackedWord) -> TrackedWord:
        return value

    def floored(self, value: TrackedWord, places: int) -> TrackedWord:
        return value.times(arb(2) ** -places).lost(_HALF, _HALF) if places else value

    def clamp(self, value: TrackedWord, low: TrackedWord, high: TrackedWord) -> TrackedWord:
        """Unchanged where surely within; elsewhere no error grows, as |clamp x - clamp y| <= |x - y|."""
        if low.value + low.error <= value.value - value.error and value.value + value.error <= high.value - high.error:
            return value
        held = value.value.max(low.value).min(high.value)
        return TrackedWord(held, {next(self._symbols): arb(max(value.error, low.error, high.error))}, self._symbols)

    def accepted(self, value: TrackedWord, last: TrackedWord) -> TrackedWord:
        return value

    def held(self, value: TrackedWord, low: TrackedWord, high: TrackedWord) -> TrackedWord:
        return self.clamp(value, low, high)

    def is_within(self, value: TrackedWord, bits: int) -> bool:
        """True, or no proof: the real law never gives up its feedback."""
        largest = upper_bound(value.value) + value.error
        if not largest < 2.0**bits:
            raise ValueError(f"ranges too wide: feedback of up to {largest:.4g} words against {2.0**bits:.4g}")
        return True

    def choose(self, condition: bool, value: TrackedWord, otherwise: TrackedWord) -> TrackedWord:
        return value if condition else otherwise

    def wrapped(self, value: TrackedWord, bits: int) -> TrackedWord:
        return value

    def towards(self, value: TrackedWord, target: TrackedWord, gain: TrackedWord) -> TrackedWord:
        step = (gain * (target - value)).times(arb(2) ** -31)
        return value + step.lost(arb(0), arb(1))

    def fraction(self, value: TrackedWord, places: int) -> TrackedWord:
        """What an earlier sum left below its last place: nothing in the real law."""
        half = arb(2) ** (places - 1)
        return TrackedWord(arb(0), {_KNOWN: half, next(self._symbols): half}, self._symbols)

    def whole(self, total: TrackedWord, places: int) -> tuple[bool, TrackedWord]:
        move = self.floored(total, places)
        return self.is_within(move, 30), move

    def both(self, one: bool, other: bool) -> bool:
        return one and other

    def narrow_product(self, value: TrackedWord, x: TrackedWord) -> TrackedWord:
        return value * x

    def short_product(self, value: TrackedWord, x: TrackedWord) -> TrackedWord:
        return value * x

    def scaled(self, value: TrackedWord, x: TrackedWord) -> TrackedWord:
        return (value * x).times(arb(2) ** -32).lost(3 * _HALF, 3 * _HALF)

    def scaled_short(self, value: TrackedWord, x: TrackedWord) -> TrackedWord:
        return self.floored(value * x, 16)


_HALF = arb(0.5)
