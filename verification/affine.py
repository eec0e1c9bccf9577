"""Numbers that carry a proved enclosure of their real value and of what float32 made of it.

A tracked number is a ball X with x in X for the real value, and an error form D = sum_k c_k eps_k with |eps_k| <= 1 and balls c_k,
so that the float32 number is x + D. Every operation follows the real one and the error exactly, to second order, and adds one
new eps for its own rounding (affine arithmetic; the balls are Arb's, so rounding of the proof itself is enclosed as well):

    (x + Dx) + (y + Dy) = (x + y) + Dx + Dy
    (x + Dx) (y + Dy)   = x y + x Dy + y Dx + Dx Dy
    |fl(z) - z|        <= half an ulp of the largest |z|, and at least 2^-150 below the normal numbers
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count

import numpy as np
from flint import arb

_LEAST_HALF_ULP = 2.0**-150
_ROUNDING_BITS = 25  # half an ulp of numbers up to 2^k is 2^(k - 25)


@dataclass(frozen=True)
class Tracked:
    """Enclosure `value` of the real number, error coefficient of each eps in `errors`."""

    value: arb
    errors: Mapping[int, arb]
    symbols: Iterator[int] = field(repr=False, compare=False)

    def __add__(self, other: "Tracked") -> "Tracked":
        return self._rounded(self.value + other.value, combined(self.errors, 1, other.errors, 1))

    def __sub__(self, other: "Tracked") -> "Tracked":
        return self._rounded(self.value - other.value, combined(self.errors, 1, other.errors, -1))

    def __mul__(self, other: "Tracked") -> "Tracked":
        errors = combined(self.errors, other.value, other.errors, self.value)
        second_order = self.error * other.error
        return self._rounded(self.value * other.value, errors, second_order)

    @property
    def error(self) -> float:
        """Upper bound of |float32 number - real number|."""
        return size_of(self.errors)

    @property
    def magnitude(self) -> float:
        """Upper bound of the float32 number's magnitude."""
        return math.nextafter(upper_bound(self.value) + self.error, math.inf)

    def with_error(self, value: arb, error: float) -> "Tracked":
        """A number of which only the size of the error is known: one fresh eps."""
        return Tracked(value, {next(self.symbols): arb(error)} if error else {}, self.symbols)

    def _rounded(self, value: arb, errors: dict[int, arb], more: float = 0.0) -> "Tracked":
        before = upper_bound(value) + size_of(errors, more)
        if before == 0.0:
            return Tracked(value, {}, self.symbols)
        own = half_ulp(math.nextafter(before, math.inf)) + more
        return Tracked(value, {**errors, next(self.symbols): arb(math.nextafter(own, math.inf))}, self.symbols)


class AffineArithmetic:
    """The law's decisions on tracked numbers; a decision that the enclosures leave open is refused, never guessed."""

    def __init__(self) -> None:
        self._symbols = count()

    def constant(self, value: float) -> Tracked:
        """A number of the table: real as the table states it, in float32 off by its own rounding."""
        deviation = float(np.float32(value)) - value
        return Tracked(arb(value), {next(self._symbols): arb(deviation)} if deviation else {}, self._symbols)

    def within(self, low: float, high: float) -> Tracked:
        """Any float32 number of low..high, the same in both laws."""
        return Tracked(arb(low).union(arb(high)), {}, self._symbols)

    def finite_or(self, value: Tracked, last: Tracked) -> Tracked:
        return value

    def clamp(self, value: Tracked, low: Tracked, high: Tracked) -> Tracked:
        """Unchanged where surely within; elsewhere no error grows, as |clamp x - clamp y| <= |x - y|."""
        inside = (
            low.value + low.error <= value.value - value.error and value.value + value.error <= high.value - high.error
        )
        if inside:
            return value
        if value.value - value.error > high.value + high.error:
            return high
        if value.value + value.error < low.value - low.error:
            return low
        held = value.value.max(low.value).min(high.value)
        return value.with_error(held, max(value.error, low.error, high.error))

    def saturate(self, value: Tracked, low: Tracked, high: Tracked, safe: Tracked) -> Tracked:
        return self.clamp(value, low, high)

    def settle(self, value: Tracked, least: Tracked) -> Tracked:
        """Unchanged where surely larger; elsewhere off by `least` at most."""
        if abs(value.value) > least.value + value.error:
            return value
        return value.with_error(value.value, value.error + upper_bound(least.value))

    def advanced(self, last: Tracked, step: Tracked, target: Tracked) -> Tracked:
        """The sum, off by an ulp in place of half of one: where it is `last`, the step was no more than half an ulp."""
        moved = last + step
        return Tracked(
            moved.value, {**moved.errors, next(self._symbols): arb(half_ulp(moved.magnitude))}, self._symbols
        )

    def is_plausible(self, value: Tracked, bound: Tracked) -> bool:
        if not value.magnitude < float(bound.value):
            raise ValueError(
                f"ranges too wide: a number of up to {value.magnitude:.3g} against {float(bound.value):.3g}"
            )
        return True

    def choose(self, condition: bool, value: Tracked, otherwise: Tracked) -> Tracked:
        return value if condition else otherwise


def half_ulp(magnitude: float) -> float:
    """Largest rounding error of a float32 operation whose exact result is at most `magnitude`."""
    fraction, exponent = math.frexp(magnitude)
    power = exponent - 1 if fraction == 0.5 else exponent
    return max(math.ldexp(1.0, power - _ROUNDING_BITS), _LEAST_HALF_ULP)


def upper_bound(ball: arb) -> float:
    """A float not below any |x| of the ball."""
    largest = float(ball.abs_upper())
    return math.nextafter(largest, math.inf) if largest else 0.0


def size_of(errors: Mapping[int, arb], more: float = 0.0) -> float:
    """A float not below any |sum_k c_k eps_k| of an error form, and `more`."""
    return upper_bound(sum((abs(c) for c in errors.values()), arb(more)))


def combined(one: Mapping[int, arb], by: arb | int, other: Mapping[int, arb], other_by: arb | int) -> dict[int, arb]:
    """The error form `by` one + `other_by` other."""
    errors = {symbol: c * by for symbol, c in one.items()}
    for symbol, c in other.items():
        errors[symbol] = errors[symbol] + c * other_by if symbol in errors else c * other_by
    return errors
