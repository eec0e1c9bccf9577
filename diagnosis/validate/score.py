"""What logs that were not fitted say of a model: how much closer its predictions come, over horizons from a row to a second.

The density that a model gives the readings y of an output a time tau ahead is normal about its prediction, with the error that it turns
out to have at that horizon: its mean log is -ln rms(tau) + const. So of two models the one predicts by

    gain = sum over outputs, mean over horizons, of ln(rms_other(tau) / rms_model(tau))

nats a reading better. `misfit` is the same against what no model could better: the sensor's own error, and the process noise q that the
model itself supposes, seen through readings of variance R = r T every T (the steady state of a filter of a free axis: Bar-Shalom, Li and
Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 8.2):

    P_x = 2^(1/2) q^(1/4) R^(3/4), P_xv = q^(1/2) R^(1/2), P_v = 2^(1/2) q^(3/4) R^(1/4)
    attainable(tau)^2 = r + P_x + 2 P_xv tau + P_v tau^2 + q tau^3 / 3

of an axis; of a measured state that is none, r + (q R)^(1/2) + q tau.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import variance_stated
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.prediction import WINDOW_S, windows
from sim.effect import Role

Array = NDArray[np.float64]
HORIZONS_S = (
    0.02,
    0.05,
    0.1,
    0.2,
    0.35,
    0.5,
    0.75,
    WINDOW_S,
)  # ends of the stretches of a window that count as one horizon each
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


def errors_of(case: Case, hypothesis: Hypothesis, read: Callable[[Hypothesis], Sequence[Array]]) -> Errors:
    """The errors of a model over all windows of the logs of `case`; `read` are its predictions (rows, outputs) of each."""
    effects = case.library.effects
    shown = [name for name in hypothesis.effects if effects[name].shown_in_readings]
    smooth = hypothesis  # what a coarse reading rounds is no error of the model
    if shown:
        smooth = hypothesis.with_effects({name: v for name, v in hypothesis.effects.items() if name not in shown})
    squares, attainable = [], []
    for flight, predicted in zip(case.flights, read(smooth), strict=True):
        error = (predicted - flight.log.y) ** 2
        mine = _attainable(case, flight, hypothesis)
        for first, last in windows(flight.log.t_s):
            horizon = np.searchsorted(HORIZONS_S, flight.log.t_s[first:last] - flight.log.t_s[first] - 1e-9)
            squares.append(_by_horizon(error[first:last], horizon))
            attainable.append(mine)
    return Errors(np.array(squares), _grid(case, hypothesis, shown), np.array(attainable))


def score(model: Errors, other: Errors) -> Score:
    """By how much `model` predicts better than `other`; the standard error is that of windows drawn with replacement."""
    known, weights = _drawn(model, other)
    if not known.any():
        return Score(0.0, np.inf, 0.0)
    gains = _gains(model, other, known, weights)
    own, best = (_log_rms(square, known, weights[:1]) for square in (model.squares, model.attainable))
    return Score(float(gains[0]), float(np.std(gains[1:])), float(_total(own - best)[0]))


def _drawn(model: Errors, other: Errors) -> tuple[NDArray[np.bool_], Array]:
    """What both models' errors are known of, and how often each window counts: once, then as drawn with replacement."""
    known = np.isfinite(model.squares) & np.isfinite(other.squares)
    count = len(known)
    rng = np.random.default_rng(SEED)
    drawn = [np.bincount(rng.integers(0, max(count, 1), count), minlength=count) for _ in range(DRAWS)]
    return known, np.concatenate([np.ones((1, count)), np.stack(drawn)])


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


def _by_horizon(error: Array, horizon: NDArray[np.int64]) -> Array:
    """Means of the rows (rows, outputs) of each horizon, NaN where one has none."""
    found = np.full((len(HORIZONS_S), error.shape[1]), np.nan)
    for place in np.unique(horizon[horizon < len(HORIZONS_S)]).tolist():
        rows = error[horizon == place]
        known = np.isfinite(rows)
        count = known.sum(axis=0)
        total = np.where(known, rows, 0.0).sum(axis=0)
        found[place] = np.divide(total, count, out=np.full(error.shape[1], np.nan), where=count > 0)
    return found


def _attainable(case: Case, flight: FilteredLog, hypothesis: Hypothesis) -> Array:
    """Mean squares (horizons, outputs) that no model could better, as the hypothesis has the noise."""
    library, model = case.library, case.library.bound.model
    begins = np.append(0.0, HORIZONS_S[:-1])
    tau = 0.5 * (begins + np.array(HORIZONS_S))
    noise = {
        str(axis.position): 10.0 ** (2.0 * q) for axis, q in zip(model.axes, hypothesis.process_noise, strict=True)
    }
    states = {state: 10.0 ** (2.0 * level) for state, level in hypothesis.state_noise.items()}
    coarse = _steps(case, hypothesis)
    found = np.empty((len(HORIZONS_S), len(model.outputs)))
    for place, (name, expression) in enumerate(model.outputs.items()):
        errors = hypothesis.reading_noise.get(name)
        r = float(flight.filter_input.single[library.outputs.index(name)])
        r = r if errors is None else variance_stated(library.bound.plant, name)
        r = max(r if np.isfinite(r) else 0.0, coarse.get(name, 0.0) ** 2 / 12.0, 1e-30)
        q = noise.get(str(expression), 0.0)
        R = r * flight.step_s
        r += 0.0 if errors is None else errors.sd**2
        r += np.sqrt(drift * R) + drift * tau if (drift := states.get(str(expression), 0.0)) > 0.0 else 0.0
        P_x, P_xv, P_v = np.sqrt(2.0) * q**0.25 * R**0.75, np.sqrt(q * R), np.sqrt(2.0) * q**0.75 * R**0.25
        found[:, place] = r + P_x + 2.0 * P_xv * tau + P_v * tau**2 + q * tau**3 / 3.0
    return found


def _steps(case: Case, hypothesis: Hypothesis) -> Mapping[str, float]:
    """The steps of the sensors that a hypothesis takes to be coarse, by output."""
    effects, sensors = case.library.effects, case.library.bound.model.places.sensors
    return {
        sensors[effects[name].place].output: values[effects[name].symbol(Role.STEP)]
        for name, values in hypothesis.effects.items()
        if effects[name].shown_in_readings
    }


def _grid(case: Case, hypothesis: Hypothesis, shown: Sequence[str]) -> Array:
    """ln(step / stated step) (outputs,) of each coarse grid: readings that can only lie so far apart are so much likelier where they do."""
    steps = _steps(case, hypothesis) if shown else {}
    sensors = case.library.bound.plant.sensors
    return np.array(
        [
            np.log(steps[name] / sensors[name]) if name in steps and sensors.get(name, 0.0) > 0.0 else 0.0
            for name in case.library.bound.model.outputs
        ]
    )
