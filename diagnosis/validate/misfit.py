"""Does the plant, with all that was found, know these logs at all? Its predictions against those of somebody who knows nothing."""

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.prediction import WINDOW_S, FreeRun, predictions, windows
from sim.bind import BoundPlant
from sim.kernel.reference import reference

LEAST_WINDOW_ROWS = 5  # of a window: fewer hardly move
Array = NDArray[np.float64]


def ignorance(case: Case, hypothesis: Hypothesis) -> dict[str, float]:
    """RMS error of predictions by output, over the RMS change of the readings since each window's start: 1 is to know nothing.

    Windows are of 1 s, or of the time constant with which an unstable plant lets an error of the start grow: beyond, nobody knows more.
    Outputs that hardly move are left out: nothing could be known better than that they stand.
    """
    outputs = list(case.library.bound.model.outputs)
    pairs = [_squares(case, flight, hypothesis) for flight in case.flights]
    own, still = (np.concatenate([pair[side] for pair in pairs]) for side in (0, 1))
    found = {}
    for place, name in enumerate(outputs):
        floor = case.flights[0].filter_input.single[case.library.outputs.index(name)]
        known = np.isfinite(own[:, place])
        if known.any() and (change := float(np.mean(still[known, place]))) > decisions.BEYOND_CHANCE**2 * floor:
            found[name] = float(np.sqrt(np.mean(own[known, place]) / change))
    return found


def _squares(case: Case, flight: FilteredLog, hypothesis: Hypothesis) -> tuple[Array, Array]:
    """Squared errors (rows, outputs) of the predictions, and of holding each window's first reading, over the same rows."""
    y, held = flight.log.y, np.full_like(flight.log.y, np.nan)
    second_s = case.second_s
    length_s = foreseen_s(case.library.bound, flight) / second_s
    spans = [FreeRun(first, first, last) for first, last in windows(flight.log.t_s, second_s, length_s)]
    for span in spans:
        held[span.first : span.last] = y[span.first]
    own, still = (predictions(case, flight, hypothesis, spans) - y) ** 2, (held - y) ** 2
    both = np.isfinite(own) & np.isfinite(still)
    return np.where(both, own, np.nan), np.where(both, still, np.nan)


def foreseen_s(bound: BoundPlant, flight: FilteredLog) -> float:
    """The time constant with which an error of the state grows, of the plant's fastest unstable pole where the log starts.

    A window at most, and a few rows at least.
    """
    model, longest_s = bound.model, WINDOW_S * bound.model.second_s
    x0, u0 = flight.x0[: len(model.states)], np.nanmedian(flight.log.u, axis=0)
    with np.errstate(all="ignore"):
        A = reference(model).A(0.0, x0, u0, bound.p, np.zeros(len(model.axes)))
    fastest_rad_s = float(np.max(np.linalg.eigvals(A).real)) if np.all(np.isfinite(A)) else 0.0
    grown_s = 1.0 / fastest_rad_s if fastest_rad_s > 0.0 else longest_s
    return min(longest_s, max(grown_s, LEAST_WINDOW_ROWS * flight.step_s))
