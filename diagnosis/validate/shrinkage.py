"""How far the gap shrinks on logs that were not fitted: errors of 1 s predictions, as stated, re-tuned and with the effects found."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.agreement import agreements
from diagnosis.validate.closed_loop import MODEL_VARIANTS, closed_loop
from diagnosis.validate.prediction import WINDOW_S, windows
from records.diagnosis import Shrinkage
from records.table import ControllerTable

Array = NDArray[np.float64]
BOOTSTRAP_DRAWS, BOOTSTRAP_SEED = 1000, 7


@dataclass(frozen=True, eq=False)
class Predicted:
    """Readings of a hold-out log predicted by each of MODEL_VARIANTS: (rows, outputs), NaN where a row could not be predicted.

    `variants` are the models that predicted, `second_s` is that of their case.
    """

    name: str
    second_s: float
    t_s: Array
    y: Array
    by: Mapping[str, Array]
    variants: Mapping[str, Hypothesis]


def predict_all(
    case: Case,
    names: Sequence[str],
    variants: Mapping[str, Hypothesis],
    read: Callable[[Hypothesis], Sequence[Array]],
) -> tuple[Predicted, ...]:
    """Predictions of every flight of `case` by each model in `variants`; `read` gives those of one, (rows, outputs) by flight."""
    found = {variant: read(hypothesis) for variant, hypothesis in variants.items()}
    return tuple(
        Predicted(
            name,
            case.second_s,
            flight.log.t_s,
            flight.log.y,
            {variant: y[place] for variant, y in found.items()},
            variants,
        )
        for place, (name, flight) in enumerate(zip(names, case.flights, strict=True))
    )


def shrinkage(case: Case, predicted: Sequence[Predicted], tables: Sequence[ControllerTable | None] = ()) -> Shrinkage:
    """RMS by output, the share of the removable error that the effects remove, and its bootstrap interval over windows.

    `tables` are the controllers that flew the logs of `case`, None where it is not at hand: those logs are flown again.
    """
    outputs = list(case.library.bound.model.outputs)
    squares = {variant: _squares(predicted, variant) for variant in MODEL_VARIANTS}
    noise = np.sqrt([case.flights[0].filter_input.single[case.library.outputs.index(name)] for name in outputs])
    # What any model leaves is no floor's: readings on a coarse grid look as noisy as its steps, and a model of the grid predicts them.
    floor = np.fmin(noise, np.sqrt(_means(squares["after"])))
    variants = {variant: _named(outputs, np.sqrt(_means(squares[variant]))) for variant in MODEL_VARIANTS}
    count = len(squares["after"])
    fraction = _fractions(squares, floor, np.ones((1, count)))
    spread = np.minimum(_fractions(squares, floor, _drawn(count)), 1.0)  # no draw takes away more than all that can be
    interval = (float(np.percentile(spread, 2.5)), float(np.percentile(spread, 97.5))) if spread.size else None
    return Shrinkage(
        rms_nominal=variants["nominal"],
        rms_before=variants["before"],
        rms_after=variants["after"],
        rms_floor=_named(outputs, floor),
        fraction=float(fraction[0]) if fraction.size else None,
        fraction_ci95=interval if fraction.size else None,
        window_s=WINDOW_S * case.second_s,
        agreement=agreements(outputs, [(entry.t_s, entry.y, entry.by) for entry in predicted]),
        closed_loop=closed_loop(case, [e.name for e in predicted], tables, predicted[0].variants)
        if any(tables)
        else None,
    )


def _squares(predicted: Sequence[Predicted], variant: str) -> Array:
    """Mean square error by window and output; NaN for an output that a log does not hold; windows lacking another are left out."""
    found = []
    for entry in predicted:
        square = (entry.by[variant] - entry.y) ** 2
        held: NDArray[np.bool_] = np.asarray(np.isfinite(entry.y).any(axis=0))
        for first, last in windows(entry.t_s, entry.second_s):
            means = _means(square[first:last])
            if held.any() and np.isfinite(means[held]).all():
                found.append(np.where(held, means, np.nan))
    return np.array(found) if found else np.full((1, predicted[0].y.shape[1]), np.nan)


def _drawn(count: int) -> Array:
    """How often each of `count` windows is drawn, (BOOTSTRAP_DRAWS, count), with replacement."""
    rng = np.random.default_rng(BOOTSTRAP_SEED)
    return np.stack(
        [np.bincount(rng.integers(0, count, count), minlength=count) for _ in range(BOOTSTRAP_DRAWS)]
    ).astype(float)


def _fractions(squares: Mapping[str, Array], floor: Array, weights: Array) -> Array:
    """Shares of the removable error that are gone, one for each row of `weights` (draws, windows) under which anything is removable."""
    before, after = (_weighted_means(squares[variant], weights) / floor**2 for variant in ("before", "after"))
    removable = np.nansum(before - 1.0, axis=1)
    gone = np.nansum(before - after, axis=1)
    return np.asarray(gone[removable > 0.0] / removable[removable > 0.0])


def _means(columns: Array) -> Array:
    """Means of the columns (rows, k) without their NaN; NaN for a column of nothing else."""
    return np.asarray(_weighted_means(columns, np.ones((1, len(columns))))[0])


def _weighted_means(columns: Array, weights: Array) -> Array:
    """Means (draws, k) of the columns (rows, k) without their NaN, under each row of `weights` (draws, rows or more)."""
    rows = min(len(columns), weights.shape[1])
    known = np.isfinite(columns[:rows])
    count = weights[:, :rows] @ known
    total = weights[:, :rows] @ np.where(known, columns[:rows], 0.0)
    return np.asarray(np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0.0))


def _named(outputs: Sequence[str], values: Array) -> dict[str, float]:
    return {name: float(value) if np.isfinite(value) else 0.0 for name, value in zip(outputs, values, strict=True)}
