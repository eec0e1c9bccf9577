"""Hold-out logs to their ends with the model left alone: one free run each, from the state that its own filter then has."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.closed_loop import MODEL_VARIANTS
from diagnosis.validate.prediction import FreeRun, predictions, settled_after_s
from records.diagnosis import Shrinkage

Array = NDArray[np.float64]


def left_alone(case: Case, variants: Mapping[str, Hypothesis]) -> Shrinkage | None:
    """Errors over all rows of the flights of `case` behind the settling of the filter, by each of MODEL_VARIANTS, as `shrinkage` has
    them of windows.

    None where no log is longer, or a variant leaves all bounds on one.
    """
    outputs = list(case.library.bound.model.outputs)
    found = {variant: _errors(case, variants[variant]) for variant in MODEL_VARIANTS}
    if not all(entry is not None and len(entry) for entry in found.values()):
        return None
    squares = {variant: _mean_squares(entry) for variant, entry in found.items() if entry is not None}
    floor = np.array([case.flights[0].filter_input.single[case.library.outputs.index(name)] for name in outputs])
    nominal, before, after = (squares[variant] for variant in MODEL_VARIANTS)
    removable = float(np.nansum(before / floor - 1.0))
    return Shrinkage(
        rms_nominal=_named(outputs, nominal),
        rms_before=_named(outputs, before),
        rms_after=_named(outputs, after),
        rms_floor=_named(outputs, floor),
        fraction=float(np.nansum((before - after) / floor)) / removable if removable > 0.0 else None,
        fraction_ci95=None,
    )


def _errors(case: Case, hypothesis: Hypothesis) -> Array | None:
    """Predicted less read (rows, outputs) of all flights, NaN where nothing was read; None where a free run failed."""
    found = [np.empty((0, len(case.library.bound.model.outputs)))]
    for flight in case.flights:
        span = _rest_of(flight, case.second_s)
        if span is not None:
            ahead = predictions(case, flight, hypothesis, [span])[span.first :]
            if not np.isfinite(ahead).any():
                return None
            found.append(ahead - flight.log.y[span.first :])
    return np.concatenate(found)


def _rest_of(flight: FilteredLog, second_s: float) -> FreeRun | None:
    """From the first row at which the filter can tell the speeds to the end; None in a log that is shorter."""
    t_s = flight.log.t_s
    start = int(np.searchsorted(t_s, t_s[0] + settled_after_s(t_s, second_s)))
    return FreeRun(start, start, len(t_s)) if start < len(t_s) - 1 else None


def _mean_squares(errors: Array) -> Array:
    """Of the columns (rows, outputs) without their NaN; NaN for an output that no log holds."""
    known = np.isfinite(errors)
    count = known.sum(axis=0)
    total = np.sum(np.where(known, errors, 0.0) ** 2, axis=0)
    return np.asarray(np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0))


def _named(outputs: list[str], mean_squares: Array) -> dict[str, float]:
    return {
        name: float(np.sqrt(value)) for name, value in zip(outputs, mean_squares, strict=True) if np.isfinite(value)
    }
