"""How a number of an effect's shape is drawn: ranges as data."""

from dataclasses import dataclass
from typing import Protocol

from numpy.random import Generator


class Source(Protocol):
    """What one number comes from."""

    def draw(self, rng: Generator) -> float:
        """One number."""


@dataclass(frozen=True)
class Fixed:
    """Always the same."""

    value: float

    def draw(self, rng: Generator) -> float:
        """That number; takes nothing from the generator."""
        return self.value


@dataclass(frozen=True)
class Uniform:
    """Anywhere from `low` to `high`."""

    low: float
    high: float

    def draw(self, rng: Generator) -> float:
        """One number of the range."""
        return float(rng.uniform(self.low, self.high))


@dataclass(frozen=True)
class Whole:
    """A whole number from `low` to below `high`."""

    low: int
    high: int

    def draw(self, rng: Generator) -> float:
        """One of them."""
        return float(rng.integers(self.low, self.high))


@dataclass(frozen=True)
class EitherSign:
    """Another source's number, as often negated as not."""

    size: Source

    def draw(self, rng: Generator) -> float:
        """The sign first, then the number."""
        return sign(rng) * self.size.draw(rng)


@dataclass(frozen=True)
class OneOf:
    """One of two sources, each as often as the other."""

    one: Source
    other: Source

    def draw(self, rng: Generator) -> float:
        """The choice first, then the number."""
        return self.one.draw(rng) if rng.random() < 0.5 else self.other.draw(rng)


def sign(rng: Generator) -> float:
    """+1 or -1."""
    return 1.0 if rng.random() < 0.5 else -1.0
