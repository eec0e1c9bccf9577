"""Stages on the way of the inputs: lost frames, delay, steps, play, slew limit, lag.

Delay and lost frames are exact. A ramp or an exponential becomes a staircase of the same mean over each piece of at most PIECE_S, so that
the speed of a rotor is right to third order of the piece.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from sim.paths.path import SAME_INSTANT_S, Array, Held, in_held_steps, played, uniform

PIECE_S = 2.5e-3
MOST_PIECES = 16
SHORTEST_S = 1e-7  # a shorter delay or lag changes nothing
NO_TIME_S = 1e-300  # of a lag that is none: a quotient by it is still a number


@dataclass(frozen=True)
class DroppedFrames:
    """Each frame but the first is lost with probability `p`, and the inputs before it stay.

    Whether frame n is lost depends on (seed, n) alone; with a larger p the same frames are lost and more.
    """

    p: float
    seed: int = 0
    order: ClassVar[int] = 0

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """See InputStage; remembers the number of frames and the inputs that hold."""
        count, last = (0, signal.values[0]) if memory is None else memory
        number = np.arange(count, count + len(signal.values))
        lost = (uniform(number, self.seed) < self.p) & (number > 0)
        arrived = np.maximum.accumulate(np.where(lost, 0, np.arange(1, len(number) + 1)))
        values = np.concatenate([last[np.newaxis], signal.values])[arrived]
        return Held(signal.edges_s, values), (count + len(number), values[-1])


@dataclass(frozen=True)
class Delay:
    """The inputs `columns` arrive `tau_s` later."""

    columns: tuple[int, ...]
    tau_s: float
    order: ClassVar[int] = 1

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """See InputStage; remembers the inputs that have not arrived yet."""
        if self.tau_s < SHORTEST_S:
            return signal, memory
        edges = signal.edges_s
        past_s, past = (np.array([-np.inf]), signal.values[:1]) if memory is None else memory
        sent_s, sent = np.concatenate([past_s, edges[:-1]]), np.concatenate([past, signal.values])
        arrivals = sent_s + self.tau_s
        starts = _merged(edges[:-1], arrivals[(arrivals > edges[0]) & (arrivals < edges[-1] - SAME_INSTANT_S)])
        values = signal.at(starts)
        late = np.searchsorted(arrivals, starts + SAME_INSTANT_S, side="right") - 1
        values[:, self.columns] = sent[late][:, self.columns]
        first = np.searchsorted(arrivals, edges[-1] + SAME_INSTANT_S, side="right") - 1
        return Held(np.append(starts, edges[-1]), values), (sent_s[first:], sent[first:])


@dataclass(frozen=True)
class Quantised:
    """The input `column` in steps of q that lie `shift` q below its multiples, each of which holds until the command is (1/2 + `hold`) q
    away from it; 0 stands for none."""

    column: int
    q: float
    hold: float = 0.0
    shift: float = 0.0
    order: ClassVar[int] = 2

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """See InputStage; remembers the step that holds, before it is shifted."""
        if self.q <= 0.0:
            return signal, None
        values, shift = signal.values.copy(), self.shift * self.q
        reached, last = in_held_steps(values[:, self.column] + shift, self.q, self.hold, memory)
        values[:, self.column] = reached - shift
        return Held(signal.edges_s, values), last


@dataclass(frozen=True)
class InputPlay:
    """The input `column` follows its command only when the play of `width` is used up; it starts in the middle of it."""

    column: int
    width: float
    order: ClassVar[int] = 3

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """See InputStage; remembers where the input is."""
        values = signal.values.copy()
        values[:, self.column], last = played(signal.values[:, self.column], self.width, memory)
        return Held(signal.edges_s, values), last


@dataclass(frozen=True)
class Memoryless:
    """What arrives of the inputs by equations, for those that stand before a stage with memory."""

    applied: Callable[[Array], Array]
    order: ClassVar[int] = 4

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """See InputStage; remembers nothing."""
        return Held(signal.edges_s, self.applied(signal.values)), None


@dataclass(frozen=True)
class SlewLimit:
    """The input `column` follows its command at `rate` per second at most."""

    column: int
    rate: float
    order: ClassVar[int] = 5

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """See InputStage; remembers where the input is."""
        wanted, long_s = signal.values[:, self.column], np.diff(signal.edges_s)
        x = wanted[0] if memory is None else memory
        at = np.empty(len(wanted) + 1)
        at[0] = x
        for k, (goal, most) in enumerate(zip(wanted.tolist(), (self.rate * long_s).tolist(), strict=True)):
            x += min(max(goal - x, -most), most)
            at[k + 1] = x
        under_way_s = np.minimum(np.abs(wanted - at[:-1]) / self.rate, long_s)
        direction = self.rate * np.sign(wanted - at[:-1])

        def mean(interval: Array, begin_s: Array, end_s: Array) -> Array:
            return np.asarray(at[interval] + direction[interval] * (begin_s + end_s) / 2)

        return _staircase(signal, self.column, under_way_s, mean), x


@dataclass(frozen=True)
class Lag:
    """The input `column` passes 1 / ((tau - tau_2) s + 1) and then 1 / (tau_2 s + 1), of which `second` = tau_2 / tau is below 1/2."""

    column: int
    tau_s: float
    second: float = 0.0
    order: ClassVar[int] = 6

    def __call__(self, signal: Held, memory: Any) -> tuple[Held, Any]:
        """See InputStage; remembers the states of both lags."""
        wanted, long_s = signal.values[:, self.column], np.diff(signal.edges_s)
        if self.tau_s < SHORTEST_S:
            return signal, (wanted[-1], wanted[-1])
        taus_s = np.array([self.tau_s * (1.0 - self.second), max(self.tau_s * self.second, NO_TIME_S)])
        ratio = taus_s[0] / (taus_s[0] - taus_s[1])
        x, behind = (wanted[0], wanted[0]) if memory is None else memory
        apart = np.empty(
            (len(wanted), 2)
        )  # of what arrives from what is wanted, at each step's begin: what fades with either lag
        stays = np.exp(-long_s[:, np.newaxis] / taus_s)
        for k, (goal, (first, second)) in enumerate(zip(wanted.tolist(), stays.tolist(), strict=True)):
            with_first = ratio * (x - goal)
            apart[k] = with_first, behind - goal - with_first
            x = goal + (x - goal) * first
            behind = goal + with_first * first + apart[k, 1] * second

        def mean(interval: Array, begin_s: Array, end_s: Array) -> Array:
            from_s, width_s = begin_s[:, np.newaxis], (end_s - begin_s)[:, np.newaxis]
            shares = np.exp(-from_s / taus_s) * -np.expm1(-width_s / taus_s) * taus_s / width_s
            return np.asarray(wanted[interval] + np.sum(apart[interval] * shares, axis=1))

        moves = np.abs(apart).sum(axis=1) > 1e-9
        return _staircase(signal, self.column, np.where(moves, long_s, 0.0), mean), (x, behind)


def _merged(edges: Array, more: Array) -> Array:
    """Both together in order, without those of `more` that fall on an edge."""
    place = np.searchsorted(edges, more)
    before, after = edges[np.maximum(place - 1, 0)], edges[np.minimum(place, len(edges) - 1)]
    apart = np.minimum(np.abs(more - before), np.abs(more - after)) > SAME_INSTANT_S
    return np.sort(np.concatenate([edges, more[apart]]))


def _staircase(signal: Held, column: int, under_way_s: Array, mean: Callable[[Array, Array, Array], Array]) -> Held:
    """Each interval's first `under_way_s` in equal pieces with the given mean values, the rest held at its own value."""
    long_s = np.diff(signal.edges_s)
    under_way_s = np.where(under_way_s < SAME_INSTANT_S, 0.0, under_way_s)
    pieces = np.minimum(np.ceil(under_way_s / PIECE_S - 1e-9), MOST_PIECES).astype(int)
    rests = (long_s - under_way_s > SAME_INSTANT_S).astype(int)
    interval = np.repeat(np.arange(len(long_s)), pieces + rests)
    number = np.arange(len(interval)) - np.repeat(np.cumsum(pieces + rests) - pieces - rests, pieces + rests)
    width_s = under_way_s / np.maximum(pieces, 1)
    moving = number < pieces[interval]
    begin_s = number * width_s[interval]
    values = signal.values[interval]
    there = interval[moving]
    values[moving, column] = mean(there, begin_s[moving], begin_s[moving] + width_s[there])
    return Held(np.append(signal.edges_s[interval] + begin_s, signal.edges_s[-1]), values)
