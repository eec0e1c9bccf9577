"""Whether what is left of a run's readings looks like errors of its sensors: size, and correlation from sample to sample."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from identification.fit.normal_equations import Point
from identification.runs.prediction import Block
from identification.runs.run import Run

Array = NDArray[np.float64]
LAGS = 20


@dataclass(frozen=True)
class ResidualTest:
    """One channel of one run.

    `rms` of the residuals in the channel's unit, `floor`, what rounding the prediction leaves, and `noise`, what its sensor alone may
    leave: rounding, a step over sqrt(12) at least, and the plant file's noise; both 0 where nobody states them.
    `fit` = 1 - |y - y_hat| / |y - mean| in norms; `whiteness_p` is the chance that errors of the sensor are at least so correlated over
    the first 20 lags. Rounded readings are correlated by nature where the motion is slow, so the correlation that rounding the
    prediction itself gives is taken off first.
    """

    run: str
    channel: str
    samples: int
    rms: float
    floor: float
    noise: float
    fit: float
    whiteness_p: float

    @property
    def motion_rms(self) -> float:
        """Of the readings about their mean."""
        return self.rms / (1.0 - self.fit) if self.fit < 1.0 else math.inf

    @property
    def white(self) -> bool:
        """Not to be told from white at the level of one in a hundred."""
        return self.whiteness_p > 0.01


def tests_at(point: Point) -> tuple[ResidualTest, ...]:
    """All channels of all runs of a fit."""
    fitted = zip(point.runs, point.blocks, strict=True)
    return tuple(test for run, blocks in fitted for test in residual_tests(run, blocks))


def residual_tests(run: Run, blocks: tuple[Block, ...]) -> tuple[ResidualTest, ...]:
    """All channels of a run."""
    places = np.concatenate([np.arange(block.place.start, block.place.stop) for block in blocks])
    residual = np.concatenate([block.residual for block in blocks]) * run.sd[places]
    found = []
    for number, channel in enumerate(run.channels):
        mine = run.channel[places] == number
        if mine.sum() > 2 * LAGS:
            step = float(run.step[number]) if run.step.size else 0.0
            noise = run.bound.plant.sensor_noise.get(channel, 0.0) if step > 0.0 else 0.0
            found.append(_test(run.name, channel, run.y[places][mine], residual[mine], step, noise))
    return tuple(found)


def _test(name: str, channel: str, y: Array, residual: Array, step: float, noise: float) -> ResidualTest:
    rounding = step * np.round((y - residual) / step) - (y - residual) if step > 0.0 else np.zeros(y.size)
    floor = float(np.sqrt(np.mean(rounding**2)))
    spread = float(np.linalg.norm(y - np.mean(y)))
    return ResidualTest(
        run=name,
        channel=channel,
        samples=y.size,
        rms=float(np.sqrt(np.mean(residual**2))),
        floor=floor,
        noise=math.hypot(max(floor, step / math.sqrt(12.0)), noise),
        fit=1.0 - float(np.linalg.norm(residual)) / spread if spread > 0.0 else 0.0,
        whiteness_p=_whiteness(residual, rounding),
    )


def _whiteness(residual: Array, rounding: Array) -> float:
    """Ljung-Box over the first lags, on the excess over the correlation of the rounding."""
    own, expected = _correlation(residual), _correlation(rounding) if np.any(rounding) else np.zeros(LAGS)
    n = residual.size
    excess = n * (n + 2) * np.sum((own - expected) ** 2 / (n - np.arange(1, LAGS + 1)))
    # Two sample correlations differ by twice the variance of one.
    return float(chdtrc(LAGS, excess / (2.0 if np.any(rounding) else 1.0)))


def _correlation(values: Array) -> Array:
    centred = values - np.mean(values)
    power = float(centred @ centred)
    if power == 0.0:
        return np.zeros(LAGS)
    return np.array([float(centred[lag:] @ centred[:-lag]) / power for lag in range(1, LAGS + 1)])
