"""The way of a signal: stages with memory between command and rotor, or between axis and reading.

A stage takes a piece of signal and what it remembers, and gives the signal behind it and what it remembers then. So a whole log at once
and a flight sample by sample go through the same code.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
S = TypeVar("S")
SAME_INSTANT_S = 1e-9


@dataclass(frozen=True, eq=False)
class Held:
    """Inputs held constant: values[k] (inputs,) from edges_s[k] to edges_s[k + 1]; edges_s (n + 1,), values (n, inputs)."""

    edges_s: Array
    values: Array

    def at(self, starts_s: Array) -> Array:
        """The values (m, inputs) that hold from each of `starts_s` (m,) on."""
        place = np.searchsorted(self.edges_s[:-1], starts_s + SAME_INSTANT_S, side="right") - 1
        return np.asarray(self.values[np.maximum(place, 0)])


@dataclass(frozen=True, eq=False)
class Trace:
    """One output over time: y at t_s (n,), and its rate dy/dt; y and rate are (n,), or (n, columns) for derivatives."""

    t_s: Array
    y: Array
    rate: Array


class InputStage(Protocol):
    """A stage on the way of the inputs; those of lower `order` come first, from the command on."""

    order: ClassVar[int]

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """The inputs behind the stage and its new memory; memory None at the beginning, with the first input held for ever before."""
        ...


class OutputStage(Protocol):
    """A stage on the way of the output number `output`; those of lower `order` come first, from the axis on."""

    order: ClassVar[int]

    @property
    def output(self) -> int:
        """The index of the output that passes it."""
        ...

    def __call__(self, signal: Trace, memory: Any) -> tuple[Trace, Any]:
        """The output behind the stage and its new memory; memory None at the beginning, which is in steady motion."""
        ...


Stage = InputStage | OutputStage


def passed(
    stages: Sequence[Callable[[S, Any], tuple[S, Any]]], signal: S, memory: Sequence[Any] | None = None
) -> tuple[S, tuple[Any, ...]]:
    """A signal, the inputs (Held) or one output (Trace), behind all its stages in order, and what each stage remembers then."""
    kept = []
    for stage, before in zip(stages, memory or [None] * len(stages), strict=True):
        signal, after = stage(signal, before)
        kept.append(after)
    return signal, tuple(kept)


def played(x: Array, width: float, follower: float | None) -> tuple[Array, float]:
    """What follows x (n,) through a play of `width`, and where it then is; a `follower` of None starts in the middle of the play."""
    half = width / 2
    at = float(x[0]) if follower is None else follower
    y = np.empty(len(x))
    for k, pushing in enumerate(x.tolist()):
        at = min(max(at, pushing - half), pushing + half)
        y[k] = at
    return y, at


def in_steps(x: Array, step: float | Array) -> Array:
    """x (..., n) in whole multiples of `step`, () or (n,), the nearest, halves to the even one; a step of 0 leaves x as it is."""
    count = np.divide(x, step, out=np.zeros(np.shape(x)), where=np.greater(step, 0.0))
    return np.where(np.greater(step, 0.0), np.rint(count) * step, x)


def in_held_steps(x: Array, step: float, hold: float, level: float | None) -> tuple[Array, float]:
    """x (n,) in multiples of `step`, each held until x is (1/2 + `hold`) steps away from it, and the last one; `level` is the one before,
    None where x begins at the nearest."""
    nearest = in_steps(x, step)
    if hold == 0.0:
        return nearest, float(nearest[-1])
    away, y = (0.5 + hold) * step, list[float]()
    at = float(nearest[0]) if level is None else level
    lower, upper = at - away, at + away  # compared without a call or an array: a fit asks for thousands of logs
    for wanted, there in zip(x.tolist(), nearest.tolist(), strict=True):
        if wanted > upper or wanted < lower:
            at, lower, upper = there, there - away, there + away
        y.append(at)
    return np.array(y), at


def uniform(number: Array, seed: int) -> Array:
    """Numbers in [0, 1) by splitmix64 of (seed, number): the same whichever way they are asked for."""
    with np.errstate(over="ignore"):
        z = number.astype(np.uint64) + np.uint64(seed) * np.uint64(0xD1B54A32D192ED03)
        z = (z + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray((z ^ (z >> np.uint64(31))) >> np.uint64(11), dtype=float) * 2.0**-53
