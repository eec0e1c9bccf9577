"""What inputs did between two rows of a log: held as they were logged, or went straight to the next; whichever the logs find likelier.

A controller that wrote the log holds its command to the next row. A log with fewer rows than commands, or of an input that somebody else
sampled, shows the ends of a way: to hold it puts it half a row late, which looks like a delay.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decisions import decided
from diagnosis.fit.gauss_newton import Fit
from diagnosis.fit.nominal import gain_over, plain_fit
from diagnosis.hypothesis.case import Case, FilteredLog
from records.reasons import Decision


def between_rows(case: Case, held: Fit) -> tuple[Case, Fit, tuple[Decision, ...]]:
    """The case and its nominal fit with smooth inputs straight between rows, where that fits better than they were `held`, and the record
    of that; the same, and none, where no input is smooth."""
    other = straight(case)
    if other is case:
        return case, held, ()
    found = plain_fit(other)
    gain = gain_over(case, held, found)
    better = gain > decisions.TAKEN_IN
    rule = decided("between_rows", "inputs", gain, decisions.TAKEN_IN, "straight" if better else "held")
    return (other, found, (rule,)) if better else (case, held, (rule,))


def straight(case: Case) -> Case:
    """The case with smooth inputs straight between rows; itself where none is smooth."""
    flights = [_straight(flight) for flight in case.flights]
    same = all(one is other for one, other in zip(flights, case.flights, strict=True))
    return case if same else case.with_flights(flights)


def _straight(flight: FilteredLog) -> FilteredLog:
    """The log with the mean of a smooth input and the next for what was held: a straight way to second order in the step."""
    u = flight.filter_input.u
    smooth = np.array([_is_smooth(column) for column in u.T], dtype=bool)
    if not smooth.any():
        return flight
    mean = 0.5 * (u + np.concatenate([u[1:], u[-1:]]))
    return replace(flight, filter_input=replace(flight.filter_input, u=np.where(smooth, mean, u)))


def _is_smooth(u: NDArray[np.float64]) -> bool:
    first, second = np.diff(u), np.diff(u, 2)
    return bool(first.any() and np.mean(second**2) < decisions.SMOOTH_INPUT**2 * np.mean(first**2))
