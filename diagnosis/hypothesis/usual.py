"""What each reading is worth under the nominal plant: what an effect makes meaningless counts as likely as that, and no more."""

from dataclasses import replace

import numpy as np

from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes


def with_usual(case: Case, nominal: Hypothesis) -> Case:
    """The case with each reading's log likelihood under the fitted nominal plant."""
    runs = passes(case, nominal)
    if runs is None:
        return case
    flights = []
    for flight, run in zip(case.flights, runs, strict=True):
        usual = flight.filter_input.usual.copy()
        for place, slot in enumerate(case.slots):
            if slot >= 0:
                own = -0.5 * (run.w[:, slot] ** 2 + np.log(run.s[:, slot]))
                usual[:, place] = np.where(np.isfinite(own), own, 0.0)
        flights.append(replace(flight, filter_input=replace(flight.filter_input, usual=usual)))
    return case.with_flights(flights)
