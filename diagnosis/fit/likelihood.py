"""How likely a hypothesis makes the logs, and the innovations of all of them in a row."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.kalman import Pass
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes

Array = NDArray[np.float64]


def stacked(runs: Sequence[Pass]) -> Array:
    """All whitened innovations in a row, 0 where nothing was measured."""
    return np.asarray(np.nan_to_num(np.concatenate([run.w.ravel() for run in runs])))


def flat_slopes(run: Pass) -> Array:
    """Slopes (rows, columns) of all whitened innovations of a pass; none of them where nothing is uncertain."""
    if run.dw is None:
        return np.zeros((run.w.size, 0))
    return run.dw.reshape(-1, run.dw.shape[2])


def likelihood(runs: Sequence[Pass]) -> float:
    """The log likelihood over all flights."""
    return sum(run.log_likelihood for run in runs)


def likelihood_of(case: Case, hypothesis: Hypothesis) -> float:
    """The log likelihood of what is supposed, -inf where the filter left all bounds."""
    runs = passes(case, hypothesis)
    return -np.inf if runs is None else likelihood(runs)
