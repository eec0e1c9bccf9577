"""A law as a Gappa script: every operation once as its arithmetic rounds it and once in real numbers.

A number is a pair of names, f (rounded) and r (real). Its definition is kept as a line of the script; a script holds only the lines
that its goal needs. Numbers whose enclosure is known from an earlier goal enter as variables with hypotheses

    f in [low, high],   r in [low, high],   f - r in [-error, error]
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from verification.affine import half_ulp
from verification.ranges import Range

# Answers a script whose goal is `x in ?` with a bound of |x|.
Prover = Callable[[str], float]


@dataclass(frozen=True)
class Line:
    """A definition `name = text;`, the names that it uses, and what is assumed of the name."""

    text: str
    uses: tuple[str, ...] = ()
    within: Range | None = None


@dataclass(frozen=True)
class Pair:
    """A number of the law: its rounded name, its real name, and the book in which both are defined."""

    f: str
    r: str
    book: "GappaBook" = field(repr=False, compare=False)
    error: float | None = None

    def __add__(self, other: "Pair | int") -> "Pair":
        return self.book.operation("+", self, other)

    def __sub__(self, other: "Pair") -> "Pair":
        return self.book.operation("-", self, other)

    def __mul__(self, other: "Pair | int") -> "Pair":
        return self.book.operation("*", self, other)


class GappaBook:
    """Definitions and hypotheses; where the law limits a number, `prove` is asked how far its rounding has come."""

    header = ""

    def __init__(self, prove: Prover) -> None:
        self._prove = prove
        self._lines: dict[str, Line] = {}
        self._ranges: dict[str, Range] = {}
        self._constants: dict[str, tuple[float, float]] = {}

    def operation(self, sign: str, one: Pair, other: Pair | int) -> Pair:
        """`one` + - or * `other`, as the arithmetic does it and in real numbers."""
        raise NotImplementedError

    def stored(self, name: str) -> str:
        """What makes any real number one of the arithmetic."""
        raise NotImplementedError

    def within(self, low: float, high: float) -> Pair:
        """Any number of the arithmetic within low..high, the same in both laws."""
        name = f"x{len(self._lines)}"
        self._lines[name] = Line("", (), (low, high))
        number = self._pair(self.stored(name), None, (name,))
        self._ranges[number.f] = (low, high)
        return number

    def known(self, number: Pair, limits: Range) -> Pair:
        """The number where its real value is within `limits`."""
        name = f"r{len(self._lines)}"
        self._lines[name] = Line(number.r, (number.r,), limits)
        return Pair(number.f, name, self)

    def clamp(self, value: Pair, low: Pair, high: Pair) -> Pair:
        """No error grows, as |clamp x - clamp y| <= |x - y|; limits that the arithmetic rounds count too."""
        (low_f, low_r), (high_f, high_r) = self._constants[low.f], self._constants[high.f]
        given = self._ranges.get(value.f)
        if given and max(low_f, low_r) <= given[0] and given[1] <= min(high_f, high_r):
            return value
        found = 0.0 if value.f == value.r else self._prove(self.script(value))
        error = max(found, abs(low_f - low_r), abs(high_f - high_r))
        return self._limited((min(low_f, low_r), max(high_f, high_r)), error)

    def demand_size(self, value: Pair, largest: float, otherwise: str) -> None:
        """Raises ValueError unless the prover finds the rounded number within `largest`."""
        if not self._prove(self.script(value, of_size=True)) <= largest:
            raise ValueError(f"ranges too wide: {otherwise}")

    def choose(self, condition: bool, value: Pair, otherwise: Pair) -> Pair:
        return value if condition else otherwise

    def script(self, goal: Pair, of_size: bool = False) -> str:
        """The script that asks for the error of `goal`, or for the size of its rounded number."""
        needed = self._needed({goal.f, goal.r})
        lines = [(name, line) for name, line in self._lines.items() if name in needed]
        definitions = "".join(f"{name} = {line.text};\n" for name, line in lines if line.text)
        hints = [
            f"{name} in [{dyadic(line.within[0])}, {dyadic(line.within[1])}]" for name, line in lines if line.within
        ]
        asked = goal.f if of_size else f"{goal.f} - {goal.r}"
        return f"{self.header}{definitions}{{ " + "\n  /\\ ".join(hints) + f"\n  -> {asked} in ? }}\n"

    def _limited(self, limits: Range, error: float) -> Pair:
        """A number of which only range and error are known."""
        if error == 0.0:
            number = self.within(*limits)
            return Pair(number.f, number.r, self, 0.0)
        real, float_ = f"r{len(self._lines)}", f"f{len(self._lines)}"
        self._lines[real] = Line("", (), limits)
        self._lines[f"x{float_}"] = Line("", (), None)
        self._lines[float_] = Line(self.stored(f"x{float_}"), (f"x{float_}",), limits)
        difference = f"d{float_}"
        self._lines[difference] = Line(f"{float_} - {real}", (float_, real), (-error, error))
        self._ranges[float_] = limits
        return Pair(float_, real, self, error)

    def _pair(self, f: str, r: str | None, f_uses: tuple[str, ...] = (), r_uses: tuple[str, ...] = ()) -> Pair:
        number = len(self._lines)
        self._lines[f"f{number}"] = Line(f, f_uses)
        if r is None:
            return Pair(f"f{number}", f"f{number}", self)
        self._lines[f"r{number}"] = Line(r, r_uses)
        return Pair(f"f{number}", f"r{number}", self)

    def _needed(self, names: set[str]) -> set[str]:
        """The names that the goal rests on, and the stated errors of those."""
        needed: set[str] = set()
        waiting = set(names)
        while waiting:
            name = waiting.pop()
            needed.add(name)
            waiting |= set(self._lines[name].uses) - needed
            if f"d{name}" in self._lines:
                waiting |= {f"d{name}"} - needed
        return needed


class GappaArithmetic(GappaBook):
    """Float32: every operation rounds to the nearest."""

    header = "@rnd = float<ieee_32, ne>;\n"

    def constant(self, value: float) -> Pair:
        """A number of the table: as float32 holds it, and as the table states it."""
        rounded = float(np.float32(value))
        number = self._pair(dyadic(rounded), dyadic(value) if rounded != value else None)
        self._constants[number.f] = (rounded, value)
        return number

    def stored(self, name: str) -> str:
        return f"rnd({name})"

    def operation(self, sign: str, one: Pair, other: Pair | int) -> Pair:
        """One rounding in float32, none in real numbers."""
        assert isinstance(other, Pair)  # the float32 law's constants are numbers of its own
        f = f"rnd({one.f} {sign} {other.f})"
        return self._pair(f, f"{one.r} {sign} {other.r}", (one.f, other.f), (one.r, other.r))

    def finite_or(self, value: Pair, last: Pair) -> Pair:
        return value

    def saturate(self, value: Pair, low: Pair, high: Pair, safe: Pair) -> Pair:
        return self.clamp(value, low, high)

    def settle(self, value: Pair, least: Pair) -> Pair:
        """Off by `least` at most; zero belongs to its range."""
        low, high = self._ranges[value.f]
        return self._limited((min(low, 0.0), max(high, 0.0)), (value.error or 0.0) + self._constants[least.f][0])

    def advanced(self, last: Pair, step: Pair, target: Pair) -> Pair:
        """The sum, off by up to an ulp either way: where it is `last`, the step was no more than half an ulp."""
        ulp = 2.0 * half_ulp(max(abs(end) for number in (last, target) for end in self._ranges[number.f]))
        off = f"x{len(self._lines)}"
        self._lines[off] = Line("", (), (-ulp, ulp))
        rounding = self._pair(off, "0", (off,))
        moved = self._pair(f"{last.f} + {step.f}", f"{last.r} + {step.r}", (last.f, step.f), (last.r, step.r))
        sums = (f"{moved.f} + {rounding.f}", f"{moved.r} + {rounding.r}")
        return self._pair(*sums, (moved.f, rounding.f), (moved.r, rounding.r))

    def restricted(self, number: Pair, limits: Range) -> Pair:
        """The number where its real value is within `limits`."""
        return self.known(number, limits)

    def is_plausible(self, value: Pair, bound: Pair) -> bool:
        """Asked of the prover: a voltage beyond the bound would be another law."""
        self.demand_size(value, self._constants[bound.f][0], "a voltage may be implausible")
        return True


def dyadic(value: float) -> str:
    """A binary number m 2^e as Gappa reads it, exactly: m b e."""
    if value == 0.0:
        return "0"
    numerator, denominator = value.as_integer_ratio()
    exponent = -(denominator.bit_length() - 1)
    while numerator % 2 == 0:
        numerator //= 2
        exponent += 1
    return f"{numerator}b{exponent}"
