"""What the past of innovations foretells of them: nats that noise with a memory can gain at most, without a pass of the filter.

Innovations w under the right noise are white. A linear law of their past, as means over rows 1, 2, 3, 4, 5 to 8, 9 to 16 and so on back,

    w_t = B (w_{t-1}, w_{t-2}, ..., mean of w_{t-8} to w_{t-5}, ...) + e_t,   gain = n / 2 (ln det S_w - ln det S_e) - columns of B / 2

gains what any filter with the same parameters could: it makes its innovations of the same past (Ljung, System Identification, 1999,
section 3.2).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.kalman import Pass
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes

Array = NDArray[np.float64]
BLOCKS = ((1, 1), (2, 2), (3, 3), (4, 4), *((2**k + 1, 2 ** (k + 1)) for k in range(2, 9)))  # rows back, from and to
RIDGE = 1e-9  # of each regressor's square, so that an output that is never read does no harm


def foretold_of(case: Case, hypothesis: Hypothesis) -> float:
    """What the innovations of a hypothesis foretell; 0 where the filter left all bounds."""
    runs = passes(case, hypothesis)
    return 0.0 if runs is None else foretold_nats(runs)


def better_noise_of(case: Case, hypothesis: Hypothesis) -> float:
    """What noise of its own could gain a hypothesis under another's: by what its innovations foretell, and by how large they are; 0 where
    the filter left all bounds."""
    runs = passes(case, hypothesis)
    return 0.0 if runs is None else foretold_nats(runs) + rescaled_nats(runs)


def rescaled_nats(runs: Sequence[Pass]) -> float:
    """Nats that innovations w of n readings an output gain once they are as large as their filter says, s the mean of w^2:

    (1)  n / 2 (s - 1 - ln s)
    """
    w = np.concatenate([run.w for run in runs])
    n, squares = np.isfinite(w).sum(axis=0), np.nansum(w**2, axis=0)
    read = squares > 0.0
    s = squares[read] / n[read]
    return float(0.5 * n[read] @ (s - 1.0 - np.log(s)))


def foretold_nats(runs: Sequence[Pass]) -> float:
    """Nats that a linear law of all outputs' past gains over white innovations, less what chance makes of its numbers."""
    count = runs[0].w.shape[1]
    xx = np.zeros((len(BLOCKS) * count,) * 2)
    xy, yy, rows = np.zeros((len(xx), count)), np.zeros((count, count)), 0
    for run in runs:
        w = np.nan_to_num(run.w)
        x = _past(w)
        xx, xy, yy, rows = xx + x.T @ x, xy + x.T @ w, yy + w.T @ w, rows + len(w)
    read = np.diag(yy) > 0.0
    if not read.any():
        return 0.0
    left = yy - xy.T @ np.linalg.solve(xx + np.diag(RIDGE * np.diag(xx) + np.finfo(float).tiny), xy)
    white, foretold = (float(np.linalg.slogdet(s[np.ix_(read, read)])[1]) for s in (yy, left))
    return 0.5 * rows * (white - foretold) - 0.5 * len(BLOCKS) * int(read.sum()) ** 2


def _past(w: Array) -> Array:
    """The means of w (rows, outputs) over each of BLOCKS, before its beginning 0 (rows, blocks x outputs)."""
    total = np.vstack([np.zeros(w.shape[1]), np.cumsum(w, axis=0)])
    rows = np.arange(len(w))
    means = [
        (total[np.maximum(rows - first + 1, 0)] - total[np.maximum(rows - last, 0)]) / (last - first + 1)
        for first, last in BLOCKS
    ]
    return np.hstack(means)
