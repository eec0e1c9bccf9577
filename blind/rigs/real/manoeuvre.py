"""What people do with a rig: commands of an open loop, references of a closed one; all drawn from one generator, of size about 1."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]
Draw = Callable[[Generator, Array], Array]


def _levels(rng: Generator, t_s: Array) -> Array:
    """From level to level as somebody turns a knob: each reached within a tenth of a second."""
    holds = rng.uniform(0.8, 4.0, int(t_s[-1] / 0.8) + 2)
    knots = np.concatenate([[0.0], np.cumsum(holds)])
    levels = rng.uniform(-1.0, 1.0, len(knots) + 1)
    index = np.searchsorted(knots, t_s, side="right") - 1
    part = np.clip((t_s - knots[index]) / 0.1, 0.0, 1.0)
    return np.asarray(levels[index] + (levels[index + 1] - levels[index]) * part)


def _multisine(rng: Generator, t_s: Array) -> Array:
    """Eight sines, flat up to a corner, each of random phase."""
    rates = 2.0 * np.pi * np.geomspace(0.05, rng.uniform(0.8, 3.0), 8) * rng.uniform(0.9, 1.1, 8)
    weight = 1.0 / np.sqrt(1.0 + (rates / 4.0) ** 2)
    phases = rng.uniform(0.0, 2.0 * np.pi, 8)
    return np.asarray(np.sin(np.outer(t_s, rates) + phases) @ weight / weight.sum() * 1.8)


def _binary(rng: Generator, t_s: Array) -> Array:
    """A random binary sequence of one clock."""
    clock_s = rng.uniform(0.2, 0.6)
    signs = rng.choice([-0.7, 0.7], int(t_s[-1] / clock_s) + 2)
    return np.asarray(signs[(t_s / clock_s).astype(int)])


def _sine(rng: Generator, t_s: Array) -> Array:
    """One sine that grows and shrinks."""
    rate = 2.0 * np.pi * rng.uniform(0.1, 0.4)
    return np.asarray(np.sin(rate * t_s + rng.uniform(0.0, 6.28)) * (0.65 + 0.35 * np.sin(0.31 * rate * t_s)))


OPEN: tuple[Draw, ...] = (_levels, _multisine, _binary)
CLOSED: tuple[Draw, ...] = (_levels, _multisine, _sine)


def drawn(kinds: tuple[Draw, ...], rng: Generator, t_s: Array) -> Array:
    """One of these over the times (n,)."""
    return kinds[rng.integers(len(kinds))](rng, t_s)
