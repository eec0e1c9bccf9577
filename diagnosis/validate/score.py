"""What logs that were not fitted say of a model: how much closer its predictions come, over horizons from a row to a second.

The density that a model gives the readings y of an output a time tau ahead is normal about its prediction, with the error that it turns
out to have at that horizon: its mean log is -ln rms(tau) + const. So of two models the one predicts by

    gain = sum over outputs, mean over horizons, of ln(rms_other(tau) / rms_model(tau))

nats a reading better. `misfit` is the same against what no model could better (attainable.py).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.attainable import attainable, coarse_steps
from diagnosis.validate.prediction import WINDOW_S, windows

Array = NDArray[np.float64]
# Ends of the stretches of a window that count as one horizon each, in the plant's own seconds.
HORIZONS_S = (
    0.02,
    0.05,
    0.1,
    0.2,
    0.35,
    0.5,
    0.75,
    WINDOW_S,
)
DRAWS, SEED = 400, 11


@dataclass(frozen=True)
class Score:
    """Nats a reading by which a model predicts better than another, its standard error, and the nats that it leaves."""

    gain: float
    sd: float
    misfit: float


@dataclass(frozen=True, eq=False)
class Errors:
    """Mean square errors (windows, horizons, outputs) of predictions, NaN where none could be judged, the nats (outputs,) that the grid
    of coarse readings adds, and what could be attained (windows, horizons, outputs)."""

    squares: Array
    grid: Array
    attainable: Array

    def of_output(self, output: int) -> "Errors":
        """Those of one output alone."""
        return Errors(self.squares[..., [output]], self.grid[[output]], self.attainable[..., [output]])

    def of_longest(self) -> "Errors":
        """Those of the longest horizon alone, whatever grid readings lie on."""
        return Errors(self.squares[:, -1:], np.zeros_like(self.grid), self.attainable[:, -1:])


def errors_of(case: Case, hypothesis: Hypothesis, read: Callable[[Hypothesis], Sequence[Array]]) -> Errors:
    """The errors of a model over all windows of the logs of `case`; `read` are its predictions (rows, outputs) of each."""
    effects = case.library.effects
    shown = [name for name in hypothesis.effects if effects[name].shown_in_readings]
    smooth = hypothesis  # what a coarse reading rounds is no error of the model
    if shown:
        smooth = hypothesis.with_effects({name: v for name, v in hypothesis.effects.items() if name not in shown})
    squares, best, second_s = [], [], case.second_s
    for flight, predicted in zip(case.flights, read(smooth), strict=True):
        found = _by_horizon((predicted - flight.log.y) ** 2, flight.log.t_s, second_s)
        squares.append(found)
        best.append(
            np.broadcast_to(attainable(case, flight, hypothesis, np.multiply(HORIZONS_S, second_s)), found.shape)
        )
    return Errors(np.concatenate(squares), _grid(case, hypothesis, shown), np.concatenate(best))


def score(model: Errors, other: Errors) -> Score:
    """By how much `model` predicts better than `other`; the standard error is that of windows drawn with replacement."""
    known, weights = _drawn(model, other)
    if not known.any():
        return Score(0.0, np.inf, 0.0)
    gains = _gains(model, other, known, weights)
    own, best = (_log_rms(square, known, weights[:1]) for square in (model.squares, model.attainable))
    return Score(float(gains[0]), float(np.std(gains[1:])), float(_total(own - best)[0]))


def by_output(model: Errors, other: Errors) -> list[Score]:
    """The same of each output alone."""
    return [score(model.of_output(place), other.of_output(place)) for place in range(len(model.grid))]


def _drawn(model: Errors, other: Errors) -> tuple[NDArray[np.bool_], Array]:
    """What both models' errors are known of, and how often each window counts: once, then as drawn with replacement."""
    known = np.isfinite(model.squares) & np.isfinite(other.squares)
    return known, _draws(len(known))


@lru_cache(maxsize=8)
def _draws(count: int) -> Array:
    """How often each of `count` windows counts (1 + DRAWS, count)."""
    rng = np.random.default_rng(SEED)
    drawn = [np.bincount(rng.integers(0, max(count, 1), count), minlength=count) for _ in range(DRAWS)]
    return np.concatenate([np.ones((1, count)), np.stack(drawn)])


def _gains(model: Errors, other: Errors, known: NDArray[np.bool_], weights: Array) -> Array:
    own, theirs = (_log_rms(square, known, weights) for square in (model.squares, other.squares))
    return _total(theirs - own) + float(np.sum(model.grid - other.grid))


def _log_rms(squares: Array, known: NDArray[np.bool_], weights: Array) -> Array:
    """ln rms (draws, horizons, outputs), NaN where nothing is known."""
    total = np.tensordot(weights, np.where(known, squares, 0.0), axes=1)
    count = np.tensordot(weights, known.astype(float), axes=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(0.5 * np.log(np.where(count > 0.0, np.maximum(total, 1e-300) / count, np.nan)))


def _total(logs: Array) -> Array:
    """The sum over outputs of the means over horizons (draws,); an output or a horizon that nobody read adds nothing."""
    known = np.isfinite(logs)
    means = np.where(known, logs, 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
    return np.asarray(means.sum(axis=1))


def _by_horizon(error: Array, t_s: Array, second_s: float) -> Array:
    """Means (windows, horizons, outputs) of the rows (rows, outputs) of each window and horizon, NaN where one has none."""
    spans, horizons = windows(t_s, second_s), len(HORIZONS_S)
    window = np.repeat(np.arange(len(spans)), [last - first for first, last in spans])
    rows = np.concatenate([np.arange(0), *(np.arange(first, last) for first, last in spans)])
    begins_s = t_s[np.array([first for first, _ in spans], dtype=int)[window]]
    horizon = np.searchsorted(np.multiply(HORIZONS_S, second_s), t_s[rows] - begins_s - 1e-9)
    inside = horizon < horizons
    rows, place = rows[inside], (window * horizons + horizon)[inside]
    known = np.isfinite(error[rows])

    def summed(values: Array) -> Array:
        sums = [np.bincount(place, column, len(spans) * horizons) for column in values.T]
        return np.stack(sums, axis=1, dtype=float).reshape(len(spans), horizons, error.shape[1])

    total, count = summed(np.where(known, error[rows], 0.0)), summed(known.astype(float))
    return np.divide(total, count, out=np.full_like(total, np.nan), where=count > 0.0)


def _grid(case: Case, hypothesis: Hypothesis, shown: Sequence[str]) -> Array:
    """ln(step / stated step) (outputs,) of each coarse grid: readings that can only lie so far apart are so much likelier where they do."""
    steps = coarse_steps(case, hypothesis) if shown else {}
    sensors = case.library.bound.plant.sensors
    return np.array(
        [
            np.log(steps[name] / sensors[name]) if name in steps and sensors.get(name, 0.0) > 0.0 else 0.0
            for name in case.library.bound.model.outputs
        ]
    )
