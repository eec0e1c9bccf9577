"""What the law of a setup is given along a flight and what it should answer, made once for all setups that share it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from replay.flight import ReplayedLog, advanced, lagged
from replay.law import FLOAT64, Fold, Setup, each, number_type

Array = NDArray[np.float64]

DOUBLE_SLACK_V = 1e-9  # two ways to write the same law in double precision stay well within this
LIMIT_SLACK_V = 2e-6
GRID_SLACK = 1e-3  # of a step: a number on a grid is known by its nearest step


class Workshop:
    """Makes followers of one flight; what several setups have in common is made once."""

    def __init__(self, flight: ReplayedLog) -> None:
        self.flight = flight
        measured = ~np.isnan(flight.logged_V).any(axis=1)
        self.lacks = np.isnan(flight.angle_rad[measured]).any(axis=0)  # angles (loops,) that answered rows do without
        self._inputs: dict[object, NDArray[Any]] = {}
        self._answers: dict[object, tuple[Array, Array]] = {}

    def inputs(self, setup: Setup) -> NDArray[Any]:
        """What the setup's law is given (n, 2 loops): references, angles."""
        key = (setup.angle_lags, setup.reference_lags, setup.folds, setup.columns, setup.signs, setup.arithmetic)
        if key not in self._inputs:
            self._inputs[key] = _inputs(self.flight, setup).astype(number_type(setup.arithmetic))
        return self._inputs[key]

    def answers(self, setup: Setup) -> tuple[Array, Array]:
        """What the setup's law should answer (n, loops), and how exactly that is known, alike; in V."""
        key = (setup.arithmetic, setup.channel, setup.output_lags, setup.angle_lags)
        if key not in self._answers:
            self._answers[key] = _wanted(self.flight, setup)
        return self._answers[key]


def _inputs(flight: ReplayedLog, setup: Setup) -> Array:
    """What the law was given (n, 2 loops): references and angles, each as late as the setup says."""
    folds = zip(flight.angle_rad.T, flight.steps_rad, each(setup.folds, setup.loops), strict=True)
    angles = [_folded(*column) for column in folds]
    lags = (*each(setup.reference_lags, setup.loops), *each(setup.angle_lags, setup.loops))
    columns = zip((*flight.reference_rad.T, *angles), lags, strict=True)
    given = np.stack([lagged(column, lag) for column, lag in columns], axis=1)
    given = given[:, list(setup.columns)] if setup.columns else given
    return np.ascontiguousarray(given * np.array(setup.signs))


def _folded(angle_rad: Array, step_rad: float, fold: Fold | None) -> Array:
    """The angle of the whole counts that are left when their integer has wrapped round or saturated."""
    if fold is None:
        return angle_rad
    if fold.saturates:
        counts = np.round(angle_rad / step_rad)
        low = round(fold.low_rad / step_rad)
        return np.asarray(np.clip(counts, low, low + round(fold.span_rad / step_rad) - 1) * step_rad)
    around = np.floor((angle_rad - fold.low_rad) / fold.span_rad)
    return np.asarray(np.round((angle_rad - around * fold.span_rad) / step_rad) * step_rad)


def _wanted(flight: ReplayedLog, setup: Setup) -> tuple[Array, Array]:
    """What the law should have answered (n, loops) in V, and how exactly that is known, alike."""
    logged, slack = flight.logged_V, flight.half_step_V
    as_float32 = logged.astype(np.float32).astype(float)
    steps = np.array(setup.channel.step_V)
    if setup.arithmetic == FLOAT64:
        rounded = (
            np.abs(np.spacing(logged.astype(np.float32))) * 0.5 * np.array_equal(as_float32, logged, equal_nan=True)
        )
        slack = slack + DOUBLE_SLACK_V + rounded
    elif not flight.inputs_are_rounded and not steps.any():
        logged = as_float32
    slack = np.where(np.isnan(slack), 0.0, slack) + GRID_SLACK * steps
    # Limits are read off the log, perhaps in more digits than float32 has.
    at_limits = np.minimum(np.abs(logged - setup.channel.low_V), np.abs(logged - setup.channel.high_V)) < LIMIT_SLACK_V
    slack = slack + LIMIT_SLACK_V * at_limits
    lags = each(setup.output_lags, setup.loops)
    logged, slack = (
        np.stack([advanced(column, lag) for column, lag in zip(values.T, lags, strict=True)], axis=1)
        for values in (logged, slack)
    )
    logged[len(logged) + min(0, *setup.angle_lags) :] = np.nan  # the log ends before the angles that it holds late
    return logged, slack
