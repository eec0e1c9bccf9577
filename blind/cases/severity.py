"""How large a gap is: 1 s predictions without the effect against those with it, in units of the noise floor."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from blind.rigs.bench import Lab
from blind.simulation.ce150 import DRY_FRICTION, Rig, uncertain
from blind.simulation.record import Record

Array = NDArray[np.float64]
SLOPE_STEP_S = 2e-3
PREDICTION_STEP_S = 5e-4


def rms(errors: Array) -> Array:
    """Root of the mean square over rows; shape (n, outputs) -> (outputs,)."""
    return np.asarray(np.sqrt(np.mean(errors**2, axis=0)))


def floor_rad(rig: Rig, records: Sequence[Record]) -> Array:
    """What the true model leaves of the angles, RMS by output: air, and encoders of the stated resolution."""
    air = rms(np.concatenate([record.exact_rad - record.shadow[:, 0] for record in records]))
    return np.asarray(np.sqrt(air**2 + np.square(rig.resolution_rad) / 12.0))


def severity(rig: Rig, records: Sequence[Record], shadow: int, coarse_rad: Array) -> float:
    """RMS of what a shadow's predictions lack against the true model's, over the floor; root of the sum over both angles.

    `coarse_rad` (outputs,): encoder steps that this shadow leaves out; they add their q^2/12.
    """
    lack = rms(np.concatenate([record.shadow[:, shadow] - record.shadow[:, 0] for record in records]))
    squares = (lack**2 + coarse_rad**2 / 12.0) / floor_rad(rig, records) ** 2
    return float(np.sqrt(np.sum(squares)))


def sensitivity(lab: Lab, rig: Rig, record: Record) -> Array:
    """Change of the 1 s predictions per sd of each uncertain parameter, rows of 40 ms: (parameters, rows, outputs)."""
    base = lab.predict(rig, record, SLOPE_STEP_S)[:: record.thin]
    columns = []
    for name, index, sd in uncertain(rig):
        moved = rig.values[name].copy()
        moved[index] += 0.3 * sd
        shifted = lab.predict(rig.with_values({name: moved}), record, SLOPE_STEP_S)[:: record.thin]
        columns.append((shifted - base) / 0.3)
    return np.array(columns)


def retune(gaps: Sequence[Array], slopes: Sequence[Array], floor: Array) -> Array:
    """Parameter steps in sd that best explain `gaps` (rows, outputs), each step held by its spread: ridge regression."""
    A = np.concatenate([(s / floor).reshape(len(s), -1) for s in slopes], axis=1).T
    b = np.concatenate([(gap / floor).ravel() for gap in gaps])
    # Rows within one window repeat one another: rows of 40 ms count as they stand, the prior as one row per parameter.
    return np.asarray(np.linalg.solve(A.T @ A + np.eye(A.shape[1]), A.T @ b))


def severity_left(
    rig: Rig, records: Sequence[Record], slopes: Sequence[Array], shadow: int, coarse_rad: Array
) -> float:
    """Severity of what re-tuning the parameters within their spread cannot explain."""
    floor = floor_rad(rig, records)
    gaps = [(record.shadow[:, 0] - record.shadow[:, shadow])[:: record.thin] for record in records]
    steps = retune(gaps, slopes, floor)
    left = [gap - np.tensordot(steps, slope, axes=1) for gap, slope in zip(gaps, slopes, strict=True)]
    return float(np.sqrt(np.sum((rms(np.concatenate(left)) ** 2 + coarse_rad**2 / 12.0) / floor**2)))


def moved_rig(rig: Rig, steps: Array) -> Rig:
    """The rig with each uncertain parameter moved by `steps` sd."""
    values = {name: value.copy() for name, value in rig.values.items()}
    for (name, index, sd), step in zip(uncertain(rig), steps, strict=True):
        values[name][index] += sd * step
    for name in values.keys() & set(DRY_FRICTION):
        values[name] = np.maximum(values[name], 0.0)
    return rig.with_values(values)
