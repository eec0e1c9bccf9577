"""Does the plant, with all that was found, know these logs at all? Its predictions against those of somebody who knows nothing."""

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.prediction import predictions, windows

Array = NDArray[np.float64]


def ignorance(case: Case, hypothesis: Hypothesis) -> dict[str, float]:
    """RMS error of 1 s predictions by output, over the RMS change of the readings since each window's start: 1 is to know nothing.

    Outputs that hardly move are left out: nothing could be known better than that they stand.
    """
    outputs = list(case.library.bound.model.outputs)
    pairs = [_squares(flight, predictions(case, flight, hypothesis)) for flight in case.flights]
    own, still = (np.concatenate([pair[side] for pair in pairs]) for side in (0, 1))
    found = {}
    for place, name in enumerate(outputs):
        floor = case.flights[0].filter_input.single[case.library.outputs.index(name)]
        known = np.isfinite(own[:, place])
        if known.any() and (change := float(np.mean(still[known, place]))) > decisions.MOVES_FLOORS**2 * floor:
            found[name] = float(np.sqrt(np.mean(own[known, place]) / change))
    return found


def _squares(flight: FilteredLog, predicted: Array) -> tuple[Array, Array]:
    """Squared errors (rows, outputs) of the predictions, and of holding each window's first reading, over the same rows."""
    y = flight.log.y
    held = np.full_like(y, np.nan)
    for first, last in windows(flight.log.t_s):
        held[first:last] = y[first]
    own, still = (predicted - y) ** 2, (held - y) ** 2
    both = np.isfinite(own) & np.isfinite(still)
    return np.where(both, own, np.nan), np.where(both, still, np.nan)
