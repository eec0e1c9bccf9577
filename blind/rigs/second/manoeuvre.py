"""What a pilot of the second rig asks for: references of several kinds, and dithers on both inputs; all drawn from one
generator."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import butter, lfilter, sosfilt

from blind.rigs.shaping import smoothed

Array = NDArray[np.float64]
Draw = Callable[[Generator, Array, int, bool], Array]


def reference(kind: str, rng: Generator, t_s: Array, axis: int, lively: bool, reach_rad: float) -> Array:
    """A reference over the times `t_s` from 0 (equally spaced), within about +-reach_rad, without jumps."""
    raw = MANOEUVRES[kind](rng, t_s, axis, lively) * reach_rad
    return smoothed(raw, t_s[1] - t_s[0], float(rng.uniform(0.12, 0.3)))


def dither(rng: Generator, t_s: Array, size_V: float) -> Array:
    """A disturbance of an input with an RMS of about half of `size_V`."""
    kind = DITHERS[rng.integers(len(DITHERS))]
    return np.asarray(size_V * kind(rng, t_s))


def _knots(rng: Generator, t_s: Array, gap_s: tuple[float, float]) -> Array:
    """Times from 0 to beyond the end, each a random gap after the one before."""
    gaps = rng.uniform(*gap_s, int(t_s[-1] / gap_s[0]) + 2)
    return np.concatenate([[0.0], np.cumsum(gaps)])


def _s_curves(rng: Generator, t_s: Array, axis: int, lively: bool) -> Array:
    """From level to level without a jump in acceleration (fifth order), with a rest at each."""
    knots = _knots(rng, t_s, (2.0, 4.5) if lively else (5.0, 10.0))
    levels = rng.uniform(-1.0, 1.0, len(knots) + 1)
    index = np.searchsorted(knots, t_s, side="right") - 1
    share = rng.uniform(0.5, 0.9)
    x = np.clip((t_s - knots[index]) / (share * (knots[index + 1] - knots[index])), 0.0, 1.0)
    return np.asarray(levels[index] + (levels[index + 1] - levels[index]) * x**3 * (10.0 - 15.0 * x + 6.0 * x**2))


def _doublets(rng: Generator, t_s: Array, axis: int, lively: bool) -> Array:
    """Up and down for as long each, then a pause."""
    out = np.zeros_like(t_s)
    for begin in _knots(rng, t_s, (4.0, 8.0)):
        width, size = rng.uniform(0.8, 1.8), rng.uniform(0.4, 1.0) * rng.choice([-1.0, 1.0])
        phase = (t_s - begin) / width
        out += size * (((phase >= 0.0) & (phase < 1.0)).astype(float) - ((phase >= 1.0) & (phase < 2.0)))
    return np.asarray(out + rng.uniform(-0.2, 0.2))


def _chirp(rng: Generator, t_s: Array, axis: int, lively: bool) -> Array:
    """A sine that grows faster, and smaller as it does, so that it can be followed."""
    low_Hz, high_Hz = rng.uniform(0.03, 0.06), rng.uniform(0.35, 0.6) * (1.0, 0.7)[axis]
    rate = np.log(high_Hz / low_Hz) / t_s[-1]
    frequency = low_Hz * np.exp(rate * t_s)
    phase = 2.0 * np.pi * (frequency - low_Hz) / rate + rng.uniform(0.0, 2.0 * np.pi)
    return np.asarray(np.sin(phase) / np.sqrt(1.0 + (frequency / 0.25) ** 2))


def _random_walk(rng: Generator, t_s: Array, axis: int, lively: bool) -> Array:
    """A walk that is drawn back to the middle."""
    step_s, memory_s = t_s[1] - t_s[0], rng.uniform(1.5, 3.0) if lively else rng.uniform(5.0, 9.0)
    keep = np.exp(-step_s / memory_s)
    walk = lfilter([1.0], [1.0, -keep], rng.standard_normal(len(t_s)) * np.sqrt(1.0 - keep**2))
    return np.asarray(np.tanh(0.7 * walk))


def _figure(rng: Generator, t_s: Array, axis: int, lively: bool) -> Array:
    """An eight that is drawn by both axes, twice as fast by the elevation."""
    rate_Hz = rng.uniform(0.05, 0.12) * (1.0 if lively else 0.5) * (2.0, 1.0)[axis]
    phase = 2.0 * np.pi * rate_Hz * t_s + rng.uniform(0.0, 2.0 * np.pi)
    return np.asarray(np.sin(phase) * (0.6 + 0.4 * np.cos(2.0 * np.pi * t_s / t_s[-1])))


def _staircase(rng: Generator, t_s: Array, axis: int, lively: bool) -> Array:
    """Equal steps up and down again."""
    steps, hold_s = int(rng.integers(4, 8)), rng.uniform(2.0, 3.5) if lively else rng.uniform(4.0, 7.0)
    stair = np.abs(np.floor(t_s / hold_s) % (2 * steps) - steps) / steps
    return np.asarray((2.0 * stair - 1.0) * rng.choice([-1.0, 1.0]))


def _holding(rng: Generator, t_s: Array, axis: int, lively: bool) -> Array:
    """Still, with one change of place on the way."""
    first = rng.uniform(-0.7, 0.7)
    second = first - np.sign(first) * rng.uniform(0.3, 1.2)
    return np.asarray(np.where(t_s < rng.uniform(0.3, 0.7) * t_s[-1], first, second))


MANOEUVRES: dict[str, Draw] = {
    "s-curves": _s_curves,
    "doublets": _doublets,
    "chirp": _chirp,
    "random walk": _random_walk,
    "figure": _figure,
    "staircase": _staircase,
    "holding": _holding,
}
LIVELY = ("s-curves", "doublets", "chirp", "random walk", "figure", "staircase")
QUIET = ("s-curves", "random walk", "figure", "staircase", "holding")


def _noise(rng: Generator, t_s: Array) -> Array:
    """Noise between two frequencies."""
    low_Hz, high_Hz = rng.uniform(0.2, 0.6), rng.uniform(2.0, 5.0)
    sos = butter(2, [low_Hz, high_Hz], "bandpass", fs=1.0 / (t_s[1] - t_s[0]), output="sos")
    raw = sosfilt(sos, rng.standard_normal(len(t_s)))
    return np.asarray(np.clip(0.5 * raw / raw.std(), -1.5, 1.5))


def _sweeps(rng: Generator, t_s: Array) -> Array:
    """Sweeps from slow to fast, one after another."""
    low_Hz, high_Hz, long_s = rng.uniform(0.1, 0.3), rng.uniform(2.0, 5.0), rng.uniform(8.0, 20.0)
    x = (t_s + rng.uniform(0.0, long_s)) % long_s
    return np.asarray(0.7 * np.sin(2.0 * np.pi * (low_Hz * x + 0.5 * (high_Hz - low_Hz) * x**2 / long_s)))


def _three_two_one_one(rng: Generator, t_s: Array) -> Array:
    """3-2-1-1: up for three units of time, down for two, up, down; then a pause of random length."""
    pattern = np.repeat([1.0, -1.0, 1.0, -1.0], [3, 2, 1, 1])
    unit_s = rng.uniform(0.15, 0.4)
    out = np.zeros_like(t_s)
    for begin in _knots(rng, t_s, (8.0 * unit_s, 12.0 * unit_s)):
        index = np.floor((t_s - begin) / unit_s).astype(int)
        inside = (index >= 0) & (index < len(pattern))
        out[inside] = 0.7 * rng.choice([-1.0, 1.0]) * pattern[index[inside]]
    return out


DITHERS = (_noise, _sweeps, _three_two_one_one)
