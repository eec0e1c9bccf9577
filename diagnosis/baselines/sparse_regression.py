"""Sparse regression of what the equations leave of the measured acceleration (SINDy on the discrepancy), axis by axis.

Angles are smoothed and differentiated twice; sequentially thresholded least squares keeps the few terms that explain the rest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from diagnosis.baselines.windows import Array, derivatives, measured_axes, states_of
from records.diagnosis import Diagnosis, PlaceShare, RankedHypothesis, Unknown
from records.log import RunLog
from sim.added_effects import every_effect
from sim.bind import BoundPlant
from sim.kernel.reference import reference
from sim.model import Axis

LEAST_TERM = 0.15  # of the largest term: smaller ones are dropped
ROUNDS = 10
TERMS_ALARM = 0.2  # share of the discrepancy that the terms must explain

VISCOUS = {"speed": "viscous"}  # a parameter of the plants, and so none of the library's effects


@dataclass(frozen=True)
class Explained:
    """What the largest term of an axis is and which share of the discrepancy all kept terms explain."""

    axis: str
    term: str
    share: float


def by_sparse_regression(bound: BoundPlant, logs: Sequence[RunLog]) -> Diagnosis:
    """A gap where kept terms explain more than TERMS_ALARM of an axis' discrepancy; its cause is the largest term's."""
    axes = {axis.position: axis for axis in bound.model.axes}
    found = [_explained(bound, axes[position], output, logs) for position, _, output in measured_axes(bound.model)]
    best = max(found, key=lambda explained: explained.share)
    gap = best.share > TERMS_ALARM
    effect = f"{best.axis}.{_causes().get(best.term, best.term)}"
    return Diagnosis(
        verdict="gap" if gap else "no gap",
        false_alarm_probability=None,
        places=(PlaceShare(best.axis, 1.0),) if gap else (),
        effects=(RankedHypothesis(effect, f"torque({best.term}) on {best.axis}", best.share, {}),) if gap else (),
        unknown=Unknown(1.0 - best.share, best.axis) if gap else Unknown(0.0),
        found=(effect,) if gap else (),
    )


@cache
def _causes() -> Mapping[str, str]:
    """What a term of the regression is called in the library."""
    return {effect.term: effect.kind for effect in every_effect() if effect.term} | VISCOUS


def _explained(bound: BoundPlant, axis: Axis, output: int, logs: Sequence[RunLog]) -> Explained:
    rows = [_rows(bound, axis, output, log) for log in logs]
    d = np.concatenate([discrepancy for discrepancy, _ in rows])
    terms = {name: np.concatenate([values[name] for _, values in rows]) for name in rows[0][1]}
    names = list(terms)
    X = np.column_stack([terms[name] for name in names])
    X = X / np.maximum(np.sqrt(np.mean(X**2, axis=0)), 1e-12)
    size = _thresholded(X, d)
    left = d - X @ size
    return Explained(axis.name, names[int(np.argmax(np.abs(size)))], 1.0 - float(np.var(left) / np.var(d)))


def _thresholded(X: Array, d: Array) -> Array:
    kept = np.ones(X.shape[1], dtype=bool)
    size = np.zeros(X.shape[1])
    for _ in range(ROUNDS):
        size[:] = 0.0
        size[kept] = np.linalg.lstsq(X[:, kept], d, rcond=None)[0]
        still = np.abs(size) > LEAST_TERM * np.max(np.abs(size))
        if np.array_equal(still, kept):
            break
        kept = still
    return size


def _rows(bound: BoundPlant, axis: Axis, output: int, log: RunLog) -> tuple[Array, Mapping[str, Array]]:
    """Measured less modelled acceleration, and the terms that may explain it."""
    x = states_of(bound, log)
    angle, speed, acceleration = derivatives(log.y[:, output], log.sample_period_s)
    states = list(bound.model.states)
    at, rates = states.index(axis.velocity), reference(bound.model).rates
    velocities = [states.index(other.velocity) for other in bound.model.axes]
    modelled = np.array(
        [rates(t, row, u, bound.p, np.sign(row[velocities]))[at] for t, row, u in zip(log.t_s, x, log.u, strict=True)]
    )
    terms = {
        "constant": np.ones_like(angle),
        "angle": angle,
        "sin(angle)": np.sin(angle),
        "cos(angle)": np.cos(angle),
        "speed": speed,
        "abs(speed) speed": np.abs(speed) * speed,
        "sgn(speed)": np.sign(speed),
    }
    terms |= {str(variable): log.u[:, k] for k, variable in enumerate(bound.model.inputs)}
    return acceleration - modelled, terms
