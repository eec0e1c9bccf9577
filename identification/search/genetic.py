"""The simple genetic algorithm of seed 001: parameters as strings of bits, roulette wheel, one-point crossover, mutation.

    (10)  k = k_min + b/(2^n - 1) (k_max - k_min)
    (11)  b = sum_i B_i 2^i,  i = 0 .. n - 1
    fitness = 100000 - J,  J = sum |e|

Population 50, crossover 0.75, mutation 0.1, about 150 generations. The text has 10000 - J, the axis of its Fig. 6 8.4e4 to 9.6e4.
Where it is silent: mutation turns each bit with probability 0.1, as in the simple algorithm that it cites, a fitness is at least 0,
and the best string so far takes the first place of each new population.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]
Bits = NDArray[np.uint8]
TOP = 100000.0


@dataclass(frozen=True)
class Settings:
    """The numbers of seed 001; `keep_best` puts the best string so far back into each population."""

    population: int = 50
    generations: int = 150
    crossover: float = 0.75
    mutation: float = 0.1
    keep_best: bool = True


@dataclass(frozen=True, eq=False)
class Code:
    """How parameters become bits: lowest and highest values (parameters,) and the number of bits of each."""

    lower: Array
    upper: Array
    bits: tuple[int, ...]

    @property
    def length(self) -> int:
        """Bits of a whole chromosome."""
        return sum(self.bits)

    def values(self, population: Bits) -> Array:
        """Eqs (10), (11): parameters (members, parameters) of chromosomes (members, length)."""
        found, begin = np.empty((len(population), len(self.bits))), 0
        for place, n in enumerate(self.bits):
            b = population[:, begin : begin + n] @ 2.0 ** np.arange(n)
            found[:, place] = self.lower[place] + b / (2.0**n - 1.0) * (self.upper[place] - self.lower[place])
            begin += n
        return found


@dataclass(frozen=True, eq=False)
class Evolved:
    """The best values (parameters,) of all generations, and for each generation the best fitness so far and the population's mean."""

    values: Array
    best: tuple[float, ...]
    mean: tuple[float, ...]


def evolve(
    code: Code,
    cost: Callable[[Array], Array],
    seed: int,
    settings: Settings = Settings(),
    watch: Callable[[Array], None] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Evolved:
    """Evolve a population; `cost` gives J (members,) of values (members, parameters), `watch` is told each better one at once.

    `progress` hears after each generation which one that was, and of how many.
    """
    rng = np.random.default_rng(seed)
    population = rng.integers(0, 2, (settings.population, code.length), dtype=np.uint8)
    champion, top = population[0], -1.0
    best: list[float] = []
    mean: list[float] = []
    for generation in range(settings.generations):
        values = code.values(population)
        fitness = np.maximum(TOP - cost(values), 0.0)
        leader = int(np.argmax(fitness))
        if fitness[leader] > top:
            champion, top = population[leader].copy(), float(fitness[leader])
            if watch is not None:
                watch(values[leader])
        best.append(top)
        mean.append(float(np.mean(fitness)))
        population = _next(population, fitness, settings, rng)
        if settings.keep_best:
            population[0] = champion
        if progress is not None:
            progress(generation + 1, settings.generations)
    return Evolved(code.values(champion[None])[0], tuple(best), tuple(mean))


def _next(population: Bits, fitness: Array, settings: Settings, rng: Generator) -> Bits:
    """Parents by roulette wheel, paired and crossed, bits mutated."""
    count, length = population.shape
    share = fitness / fitness.sum() if fitness.sum() > 0.0 else None
    children = population[rng.choice(count, count, p=share)]
    for first in range(0, count - 1, 2):
        if rng.random() < settings.crossover:
            cut = int(rng.integers(1, length))
            children[[first, first + 1], cut:] = children[[first + 1, first], cut:]
    return np.asarray(children ^ (rng.random((count, length)) < settings.mutation), dtype=np.uint8)
