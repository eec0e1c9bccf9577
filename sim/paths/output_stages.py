"""Stages on the way of an output: play, lag, delay, steps.

Between samples an output is the cubic through both values and rates: right to the fourth order of the sample period, to the second where
the axis stops or breaks away.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from sim.paths.path import Array, Trace, in_steps, played, uniform

SHORTEST_S = 1e-7


@dataclass(frozen=True)
class Play:
    """Backlash: what is measured follows the axis only when the play of `width` is used up; it starts in the middle of it."""

    output: int
    width: float
    order: ClassVar[int] = 0

    def __call__(self, signal: Trace, memory: Any) -> tuple[Trace, Any]:
        """See OutputStage; remembers where the follower is."""
        y, follower = played(signal.y, self.width, memory)
        pushed = np.abs(np.abs(signal.y - y) - self.width / 2) <= 1e-12
        return Trace(signal.t_s, y, np.where(pushed, signal.rate, 0.0)), follower


@dataclass(frozen=True)
class OutputLag:
    """1 / (tau s + 1): with e = y - (lagged y), e' = y' - e / tau, integrated exactly for a y' quadratic in time."""

    output: int
    tau_s: float
    order: ClassVar[int] = 1

    def __call__(self, signal: Trace, memory: Any) -> tuple[Trace, Any]:
        """See OutputStage; remembers the last sample and how far it was behind."""
        if self.tau_s < SHORTEST_S:
            return signal, memory
        before, behind = memory or (Trace(signal.t_s[:1], signal.y[:1], signal.rate[:1]), self.tau_s * signal.rate[0])
        trace = _joined(before, signal)
        stays, more = self._steps(trace)
        result = np.empty(signal.y.shape)
        for k in range(len(result)):
            behind = behind * stays[k] + more[k]
            result[k] = behind
        last = Trace(signal.t_s[-1:], signal.y[-1:], signal.rate[-1:])
        return Trace(signal.t_s, signal.y - result, result / self.tau_s), (last, behind)

    def _steps(self, trace: Trace) -> tuple[Array, Array]:
        """How much of e stays over each step, and what y' adds: its quadratic's moments under the exponential."""
        shape = (-1, *[1] * (trace.y.ndim - 1))
        h = np.diff(trace.t_s).reshape(shape)
        ratio = np.divide(self.tau_s, h, out=np.zeros(h.shape), where=h > 0.0)
        stays = np.exp(-h / self.tau_s)
        first = ratio * -np.expm1(-h / self.tau_s)
        second = ratio * (1.0 - first)
        third = ratio * (1.0 - 2.0 * second)
        begin, end = trace.rate[:-1], trace.rate[1:]
        mean = np.divide(np.diff(trace.y, axis=0), h, out=np.zeros(begin.shape), where=h > 0.0)
        bulge = 6.0 * (mean - (begin + end) / 2)
        return stays, h * (begin * (first - second) + end * second + bulge * (second - third))


@dataclass(frozen=True)
class OutputDelay:
    """What is measured is `tau_s` old; before the first sample the output moved on steadily.

    Sample n is older or younger by something even of standard deviation `jitter_s`, but never from the future; what, depends on
    (seed, n) alone.
    """

    output: int
    tau_s: float
    jitter_s: float = 0.0
    seed: int = 0
    order: ClassVar[int] = 2

    def __call__(self, signal: Trace, memory: Any) -> tuple[Trace, Any]:
        """See OutputStage; remembers the number of samples and those that are still needed."""
        if self.tau_s < SHORTEST_S:
            return signal, memory
        count, past = memory or (0, None)
        trace = signal if past is None else _joined(past, signal)
        end = count + len(signal.t_s)
        apart = self.jitter_s * np.sqrt(12.0) * (uniform(np.arange(count, end), self.seed) - 0.5)
        y, rate = _cubic(trace, signal.t_s - np.maximum(self.tau_s + apart, 0.0))
        oldest_s = signal.t_s[-1] - self.tau_s - np.sqrt(3.0) * self.jitter_s
        first = max(int(np.searchsorted(trace.t_s, oldest_s)) - 1, 0)
        return Trace(signal.t_s, y, rate), (end, Trace(trace.t_s[first:], trace.y[first:], trace.rate[first:]))


@dataclass(frozen=True)
class OutputSteps:
    """Readings in steps of q; 0 stands for none."""

    output: int
    q: float
    order: ClassVar[int] = 3

    def __call__(self, signal: Trace, memory: Any) -> tuple[Trace, Any]:
        """See OutputStage; remembers nothing."""
        if self.q <= 0.0:
            return signal, None
        return Trace(signal.t_s, in_steps(signal.y, self.q), signal.rate), None


def _joined(before: Trace, after: Trace) -> Trace:
    return Trace(
        np.concatenate([before.t_s, after.t_s]),
        np.concatenate([before.y, after.y]),
        np.concatenate([before.rate, after.rate]),
    )


def _cubic(trace: Trace, at_s: Array) -> tuple[Array, Array]:
    """Value and rate at `at_s` of the cubics through the samples; a straight line before the first."""
    t = trace.t_s
    if len(t) == 1:
        away = (at_s - t[0]).reshape(-1, *[1] * (trace.y.ndim - 1))
        return trace.y[0] + away * trace.rate[0], np.broadcast_to(trace.rate[0], (len(at_s), *trace.y.shape[1:])).copy()
    place = np.clip(np.searchsorted(t, at_s, side="right") - 1, 0, len(t) - 2)
    shape = (-1, *[1] * (trace.y.ndim - 1))
    h = (t[place + 1] - t[place]).reshape(shape)
    s = ((at_s - t[place]).reshape(shape)) / h
    y0, y1, r0, r1 = trace.y[place], trace.y[place + 1], trace.rate[place] * h, trace.rate[place + 1] * h
    square, cube = 3 * (y1 - y0) - 2 * r0 - r1, 2 * (y0 - y1) + r0 + r1
    y = np.where(s < 0.0, y0 + r0 * s, y0 + s * (r0 + s * (square + s * cube)))
    return y, np.where(s < 0.0, r0, r0 + s * (2 * square + 3 * s * cube)) / h
