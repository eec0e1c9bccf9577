"""Which of the effects that promise something to try: the most promising, and one that is unlike them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.by_log import with_start
from diagnosis.detect.forward import LEFT, forward, without
from diagnosis.detect.linearisation import Linearisation, Scores
from diagnosis.detect.starts import ScoreTest
from diagnosis.fit.likelihood import stacked
from diagnosis.hypothesis.hypothesis import passes
from jobs.thread_map import thread_map

Array = NDArray[np.float64]


def unlike(linearisation: Linearisation, score_tests: Sequence[ScoreTest], count: int) -> list[ScoreTest]:
    """The first `count` of the score tests, and that of the others which promises most beside them:

    (1)  gain_i |c_i - projection of c_i onto those taken|^2 / |c_i|^2

    with c_i (rows,) the change of the innovations by the i-th effect as it is proposed, the plant's coefficients taken out. Effects that
    are alike, as all that coarse readings look like, would else take every place from a second cause.
    """
    if len(score_tests) <= count:
        return list(score_tests)
    changes = thread_map(lambda entry: change(linearisation, entry), score_tests)
    scores, units = linearisation.scores_of(np.stack(changes, axis=1)), np.eye(len(score_tests))
    gain, whole = np.array([entry.gain for entry in score_tests]), np.maximum(np.diag(scores.gram), 1e-300)

    def promised(left: Scores) -> Array:
        share = np.diag(left.gram) / whole
        return np.where(share > LEFT, gain * share, 0.0)

    further = forward(without(scores, units[:, :count]), promised, lambda k: units[:, [k]], 1)
    return [*score_tests[:count], *(score_tests[k] for k in further)]


def change(linearisation: Linearisation, proposed: ScoreTest) -> Array:
    """The change of the whitened innovations (rows,) by an effect as it is proposed; 0 where the filter fails by it."""
    case = linearisation.case
    effect = case.library.effects[proposed.effect]
    runs = passes(case, with_start(case, linearisation.fit.hypothesis, effect, proposed.values, proposed.denied))
    return np.zeros_like(linearisation.w) if runs is None else stacked(runs) - linearisation.w
