"""Columns that may be other than they are called: from what gain on another reading of them is told, and from what on it refuses the logs.

Another reading is a hypothesis like any other, with one prior whether a sign is turned, two columns are swapped, or some stand in other
rows. Where the plant as stated is far from its rig it is asked with the dry friction and the constant force that rigs have.
"""

from collections.abc import Callable

import numpy as np

from diagnosis import decisions
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import settled
from diagnosis.hypothesis.case import Case, first_rows
from diagnosis.hypothesis.hypothesis import Hypothesis, nominal_hypothesis
from diagnosis.search.draughts import gust_shares
from jobs.thread_map import thread_map
from records.errors import BadInput

COLUMNS_ROWS = 4000  # of each log, by which its columns are asked: time; seven times as many as tell, a nat a row


def looked_at(case: Case) -> Case:
    """The rows of each log by which columns are asked."""
    return first_rows(case, COLUMNS_ROWS)


def is_strained(case: Case, fit: Fit) -> bool:
    """Whether the plant as stated is far off the logs: in a parameter, or in what the noise must do."""
    hypothesis = fit.hypothesis
    return bool(
        np.max(np.abs(hypothesis.theta), initial=0.0) > decisions.ANOTHER_PLANT
        or np.max(hypothesis.process_noise, initial=-np.inf) > decisions.FIRST_PROCESS_NOISE
        or max(gust_shares(case, hypothesis).values(), default=0.0) >= decisions.USUAL_GUST
    )


def is_told(gain: float) -> bool:
    """Whether another reading gains so many nats that it is to be told."""
    return gain > decisions.PLAIN_TO_SEE


def is_refused(gain: float) -> bool:
    """Whether it gains so many that it refuses the logs."""
    return gain > decisions.LOGS_DOUBTED


def is_as_good(gain: float, best: float) -> bool:
    """Whether a reading gains so nearly as much as the best that these logs do not tell both apart."""
    return not is_told(best - gain)


def fitted_or_none(case: Case, fitted: Callable[[Case], Fit]) -> Fit | None:
    """The fit to a case; None where it cannot be run along its logs."""
    try:
        return fitted(case)
    except BadInput:
        return None


def settled_or_none(case: Case, start: Hypothesis) -> Fit | None:
    """The fit from a start; None where the plant cannot be run along the logs."""
    return fitted_or_none(case, lambda case: settled(case, start))


def with_usual_forces(case: Case, plain: Fit) -> Fit:
    """The plant as it follows the logs: with dry friction and a constant force on every axis where it is far from its rig without them and
    surely likelier with them, else as it is."""
    if not is_strained(case, plain):
        return plain
    starts = (plain.hypothesis, nominal_hypothesis(case, float(decisions.FIRST_PROCESS_NOISE)))
    forced = thread_map(lambda start: settled_or_none(case, _with_forces(case, start)), starts)
    best = max((found for found in forced if found is not None), key=lambda found: found.log_posterior, default=plain)
    return best if is_told(best.log_posterior - plain.log_posterior) else plain


def _with_forces(case: Case, start: Hypothesis) -> Hypothesis:
    """The same with dry friction and a constant force on every axis that has none yet."""
    effects = {name: effect for name, effect in case.library.effects.items() if effect.everywhere}
    sizes = {name: {p.symbol: p.reference for p in effect.parameters} for name, effect in effects.items()}
    return start.with_effects(sizes | dict(start.effects))
