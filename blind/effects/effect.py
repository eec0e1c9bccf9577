"""What an effect of the benchmark is: one row of data, from which all is drawn, set and judged."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from math import inf, sqrt

from numpy.random import Generator

from blind.effects.draws import Source, sign
from blind.effects.equivalent import Equivalents
from blind.effects.visited import Visited

Shape = Mapping[str, float]
Settings = Mapping[tuple[str, int], float]
SCALAR = -1  # the index of a field that is one number, no pair


def times(at_one: float, m: float) -> float:
    """A number that grows with the effect."""
    return at_one * m


def over(at_one: float, m: float) -> float:
    """A limit, which is lower the larger the effect."""
    return at_one / m


def over_root(at_one: float, m: float) -> float:
    """The frequency of a spring, which is softer the larger the effect."""
    return at_one / sqrt(m)


@dataclass(frozen=True)
class Size:
    """The number that says how large an effect is: a field of the simulation's effects_t, its value at m = 1, how it goes with m.

    No field where the effect acts elsewhere: on the plant's own friction, on frames.
    """

    field: str
    at_one: float
    law: Callable[[float, float], float] = times
    most: float = inf

    def at(self, m: float) -> float:
        """The number for an effect of size m, in the field's unit."""
        return min(self.law(self.at_one, m), self.most)


def _nothing(m: float, shape: Shape, visited: Visited) -> Equivalents:
    return {}


@dataclass(frozen=True, eq=False)
class Effect:
    """An effect whose size is one number m (1 = reference), from `bounds`.

    What it is called: `places` are right answers, the first one where it acts; `twins` names whose formula says the same;
    `keywords` occur in a fitting name of a larger library; `known` where the contract's table holds it.
    What it sets: `size`, times a drawn sign where `signed`; fields of its shape that are `drawn`, in this order; fields that are
    `fixed`; each at all `indices` of its field, but those of `single` fields, which are one number.
    `equivalent`: its size in the library's words. `sensor`: what the sensors show differs from how the rig moves. `needs`: a kind of
    flight. `hides`: the plant parameter that it is, which the plant file states as 0. `loses_frames`: its size is their share.
    """

    name: str
    places: tuple[str, ...]
    depends: str
    size: Size
    drawn: Mapping[str, Source] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    signed: bool = False
    indices: tuple[int, ...] = (SCALAR,)
    single: tuple[str, ...] = ()
    bounds: tuple[float, float] = (0.01, 10.0)
    equivalent: Callable[[float, Shape, Visited], Equivalents] = _nothing
    known: bool = False
    sensor: bool = False
    needs: str = ""
    twins: tuple[str, ...] = ()
    keywords: tuple[str, ...] = ()
    hides: str = ""
    loses_frames: bool = False

    def draw(self, rng: Generator) -> Shape:
        """What makes one such effect differ from another of its size."""
        signs = {"sign": sign(rng)} if self.signed else {}
        return signs | {name: source.draw(rng) for name, source in self.drawn.items()}

    def amplitude(self, m: float, shape: Shape) -> float:
        """The size with its sign, in its field's unit."""
        return self.size.at(m) * shape.get("sign", 1.0)

    def settings(self, m: float, shape: Shape) -> Settings:
        """(field of effects_t, index) -> value."""
        if not self.size.field:
            return {}
        values = {self.size.field: self.amplitude(m, shape)}
        values |= {name: shape[name] for name in self.drawn} | dict(self.fixed)
        return {(name, index): value for name, value in values.items() for index in self.indices_of(name)}

    def indices_of(self, name: str) -> tuple[int, ...]:
        """Where a field of this effect is set."""
        return (SCALAR,) if name in self.single else self.indices


@dataclass(frozen=True, eq=False)
class Catalogue:
    """Effects of a kind of rig: those of the contract's table, those of the loop's timing, those outside the table."""

    known: tuple[Effect, ...]
    timing: tuple[Effect, ...]
    outside: tuple[Effect, ...]

    @property
    def all(self) -> tuple[Effect, ...]:
        """Every one."""
        return (*self.known, *self.timing, *self.outside)


def effects_struct(effects: Iterable[Effect]) -> str:
    """C: the structure effects_t, all that these effects set, in SI units as the fields' names say.

    Raises ValueError where one effect takes for a number what another takes for a pair.
    """
    pairs: dict[str, bool] = {}
    for effect in effects:
        for name in (effect.size.field, *effect.drawn, *effect.fixed) if effect.size.field else ():
            pair = effect.indices_of(name) != (SCALAR,)
            if pairs.setdefault(name, pair) != pair:
                raise ValueError(f"{name} of {effect.name} is a pair for one effect and a number for another")
    return "\n".join(
        [
            "/* What may be wrong with the rig. A zero switches an effect off. */",
            "typedef struct {",
            *(f"    double {name}{'[2]' if pair else ''};" for name, pair in pairs.items()),
            "} effects_t;",
        ]
    )
