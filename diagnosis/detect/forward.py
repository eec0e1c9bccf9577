"""Forward selection (Miller 2002): of many columns in turn that which gains most once those taken before are taken out."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.linearisation import Scores

Array = NDArray[np.float64]
LEFT = 1e-6  # share of a squared norm below which nothing but rounding is left of a column


def forward(scores: Scores, gains: Callable[[Scores], Array], columns: Callable[[int], Array], count: int) -> list[int]:
    """So many choices, best first: `gains` of all choices by scores (n columns), and the combinations (n, m) of columns that one takes.

    (1)  G <- G - G C (C'G C)^-1 C'G,   g <- g - G C (C'G C)^-1 C'g

    G the products of the columns, g their scores, C what was taken: what is like it gains nothing more.
    """
    chosen: list[int] = []
    while len(chosen) < count:
        gained = gains(scores)
        best = int(np.argmax(gained))
        if gained[best] <= 0.0:
            break
        chosen.append(best)
        scores = without(scores, columns(best))
    return chosen


def without(scores: Scores, taken: Array) -> Scores:
    """The scores of (1), those of `taken` (n, m) taken out; `raw` stays as it was."""
    met = scores.gram @ taken
    own = taken.T @ met
    share = np.linalg.solve(own + LEFT**2 * np.trace(own) * np.eye(len(own)) + np.finfo(float).tiny, met.T)
    return Scores(scores.gram - met @ share, scores.score - share.T @ (taken.T @ scores.score), scores.raw)


def gain_of(score: Array, norm: Array, whole: Array) -> Array:
    """What columns gain by their scores and squared norms, 0 where of the `whole` norm nothing is left."""
    shown = norm > np.maximum(LEFT * whole, 0.0)  # whose rounding may leave less than none
    return np.asarray(
        0.5 * np.divide(score, np.sqrt(np.where(shown, norm, 1.0)), out=np.zeros_like(score), where=shown) ** 2
    )
