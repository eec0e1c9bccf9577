"""Which of the effects that promise something to try: each by what those before it leave of its signature."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.score_tests import ScoreTest
from diagnosis.fit.gauss_newton import stacked
from diagnosis.hypothesis.hypothesis import passes
from jobs.thread_map import thread_map

Array = NDArray[np.float64]


def unlike(linearisation: Linearisation, score_tests: Sequence[ScoreTest], count: int) -> list[ScoreTest]:
    """So many of the score tests, in turn that which promises most beside those taken before:

    (1)  gain_i |c_i - projection of c_i onto those taken|^2 / |c_i|^2

    with c_i (rows,) the change of the innovations by the i-th effect as it is proposed, the plant's coefficients taken out. Effects that
    are alike, as all that coarse readings look like, would else take every place from a second cause; which of them it is their exchange
    tells. One by which the filter fails comes last.
    """
    if len(score_tests) <= count:
        return list(score_tests)
    left = thread_map(lambda entry: signature(linearisation, entry), score_tests)
    whole = [max(float(c @ c), 1e-300) for c in left]
    chosen: list[int] = []
    while len(chosen) < count:
        promised = [entry.gain * float(c @ c) / w for entry, c, w in zip(score_tests, left, whole, strict=True)]
        best = max((k for k in range(len(left)) if k not in chosen), key=lambda k: promised[k])
        chosen.append(best)
        own = left[best] / max(float(np.linalg.norm(left[best])), 1e-150)
        left = [c - (own @ c) * own for c in left]
    return [score_tests[k] for k in chosen]


def signature(linearisation: Linearisation, proposed: ScoreTest) -> Array:
    """The change of the whitened innovations (rows,) by an effect as it is proposed, less what the plant's coefficients imitate of it."""
    hypothesis = linearisation.fit.hypothesis
    runs = passes(linearisation.case, hypothesis.with_effects({**hypothesis.effects, proposed.effect: proposed.values}))
    if runs is None:
        return np.zeros(len(linearisation.w))
    change = stacked(runs) - linearisation.w
    return np.asarray(change - linearisation.slopes @ (linearisation.solve @ (linearisation.slopes.T @ change)))
