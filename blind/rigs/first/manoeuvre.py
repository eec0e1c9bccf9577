"""What a run asks of the rig: references, dither, air, timing; all drawn from one generator."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import lfilter

from blind.rigs.first.simulation import GUSTS, PERIOD_S, ROW_STEPS, STEP_S
from blind.rigs.shaping import smoothed
from blind.simulation.flight import RunInputs

Array = NDArray[np.float64]
SETTLE_ROWS = 300
REFERENCE_KINDS = ("steps", "ramps", "sines", "multisine")
DITHER_KINDS = ("prbs", "multisine")


@dataclass(frozen=True)
class FirstStyle:
    """How a case is flown: kinds of reference and dither, ranges in rad, air in N m, timing; `loss` the share of lost frames."""

    duration_s: float
    excited: bool
    elevation_rad: float
    azimuth_rad: float
    dither_V: tuple[float, float]
    air_Nm: tuple[float, float]
    jitter: bool
    loss: float


def draw_style(rng: Generator, excited: bool, duration_s: float) -> FirstStyle:
    """Quiet: gentle, small, no dither. Excited: larger and faster references with dither on both inputs."""
    lively = 1.0 if excited else 0.5
    air = 10.0 ** rng.uniform(-3.4, -2.7, 2) * np.array([4.37e-3, 4.14e-3]) / np.sqrt(0.04)
    return FirstStyle(
        duration_s=duration_s,
        excited=excited,
        elevation_rad=float(np.deg2rad(rng.uniform(18.0, 30.0) * (0.6 + 0.4 * lively))),
        azimuth_rad=float(np.deg2rad(rng.uniform(40.0, 90.0) * (0.5 + 0.5 * lively))),
        dither_V=(float(rng.uniform(0.3, 0.7)), float(rng.uniform(0.6, 1.5))) if excited else (0.0, 0.0),
        air_Nm=(float(air[0]), float(air[1])),
        jitter=bool(rng.random() < 0.12),
        loss=0.0,
    )


def make_inputs(style: FirstStyle, rng: Generator) -> RunInputs:
    """One run in that style: 3 s to settle, then `duration_s` that are logged."""
    rows = SETTLE_ROWS + round(style.duration_s / PERIOD_S)
    reference = np.column_stack([_reference(style, rng, rows, axis) for axis in range(2)])
    dither = np.column_stack([_dither(style, rng, rows, axis) for axis in range(2)])
    steps = np.full(rows, ROW_STEPS, np.int32)
    if style.jitter:
        steps[SETTLE_ROWS:] += rng.integers(-8, 9, rows - SETTLE_ROWS, dtype=np.int32)
    lost = rng.random(rows) < style.loss
    lost[:SETTLE_ROWS] = False
    return RunInputs(
        settle=SETTLE_ROWS,
        step_s=STEP_S,
        steps=steps,
        reference=reference,
        dither_V=dither,
        gust=_air(style, rng, rows),
        gust_steps=ROW_STEPS // GUSTS,
        lost=lost.astype(np.uint8),
    )


def _reference(style: FirstStyle, rng: Generator, rows: int, axis: int) -> Array:
    reach = style.elevation_rad if axis == 0 else style.azimuth_rad
    kind = REFERENCE_KINDS[rng.integers(len(REFERENCE_KINDS))]
    t = np.arange(rows) * PERIOD_S
    if kind in ("steps", "ramps"):
        raw = _levels(rng, rows, reach, (2.5, 6.0) if style.excited else (5.0, 12.0))
        rate = np.deg2rad(rng.uniform(40.0, 90.0) if kind == "steps" else rng.uniform(8.0, 25.0))
        shaped = _limited(raw, rate * PERIOD_S)
    else:
        top_Hz = (0.45 if style.excited else 0.15) * (1.0 if axis == 0 else 0.7)
        count = 1 if kind == "sines" else 5
        frequencies = rng.uniform(0.04, top_Hz, count)
        phases = rng.uniform(0.0, 2.0 * np.pi, count)
        weights = rng.uniform(0.5, 1.0, count) / np.sqrt(1.0 + (frequencies / 0.15) ** 2)
        waves = weights[:, None] * np.sin(2.0 * np.pi * frequencies[:, None] * t + phases[:, None])
        shaped = reach * waves.sum(axis=0) / weights.sum() + rng.uniform(-0.15, 0.15) * reach
    return smoothed(shaped, PERIOD_S, 0.25)


def _levels(rng: Generator, rows: int, reach: float, hold_s: tuple[float, float]) -> Array:
    levels = np.empty(rows)
    row = 0
    while row < rows:
        hold = int(rng.uniform(*hold_s) / PERIOD_S)
        levels[row : row + hold] = rng.uniform(-reach, reach)
        row += hold
    return levels


def _limited(raw: Array, step: float) -> Array:
    shaped = np.empty_like(raw)
    value = raw[0]
    for row, wanted in enumerate(raw):
        value += min(max(wanted - value, -step), step)
        shaped[row] = value
    return shaped


def _dither(style: FirstStyle, rng: Generator, rows: int, axis: int) -> Array:
    size = style.dither_V[axis]
    if size == 0.0:
        return np.zeros(rows)
    if DITHER_KINDS[rng.integers(len(DITHER_KINDS))] == "prbs":
        hold = int(rng.integers(6, 22))
        bits = np.sign(rng.standard_normal(rows // hold + 1))
        return size * np.repeat(bits, hold)[:rows]
    t = np.arange(rows) * PERIOD_S
    frequencies = rng.uniform(0.3, 6.0, 8)
    phases = rng.uniform(0.0, 2.0 * np.pi, 8)
    waves: Array = np.sin(2.0 * np.pi * frequencies[:, None] * t + phases[:, None]).sum(axis=0)
    return size * waves / 2.0


def _air(style: FirstStyle, rng: Generator, rows: int) -> Array:
    """Turbulence: torques of an Ornstein-Uhlenbeck process, 20 ms, held for 1 ms each."""
    keep = np.exp(-1.0 / (20.0 * GUSTS / 10.0))
    white = rng.standard_normal((rows * GUSTS, 2)) * np.sqrt(1.0 - keep**2)
    torque = lfilter([1.0], [1.0, -keep], white, axis=0) * np.asarray(style.air_Nm)
    return np.ascontiguousarray(torque.reshape(rows, GUSTS, 2))
