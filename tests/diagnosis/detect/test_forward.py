"""What is taken out of scores leaves what least squares leave."""

import numpy as np
import pytest

from diagnosis.detect.forward import forward, gain_of, without
from diagnosis.detect.linearisation import Scores

RNG = np.random.default_rng(3)
COLUMNS, W = RNG.normal(size=(40, 4)), RNG.normal(size=40)


def scores(columns: np.ndarray, w: np.ndarray) -> Scores:
    gram = columns.T @ columns
    return Scores(gram, -columns.T @ w, np.diag(gram).copy())


def test_what_was_taken_is_projected_out_of_all_others() -> None:
    # Truth: least squares of each column, and of w, on the two that were taken.
    taken = COLUMNS[:, :2]
    left = COLUMNS - taken @ np.linalg.lstsq(taken, COLUMNS, rcond=None)[0]
    found, expected = without(scores(COLUMNS, W), np.eye(4)[:, :2]), scores(left, W)
    assert found.gram == pytest.approx(expected.gram, abs=1e-9)
    assert found.score == pytest.approx(expected.score, abs=1e-9)


def test_in_turn_each_gains_most_beside_those_before_and_nothing_is_taken_twice() -> None:
    # Truth by hand: w is 3 along x and 2 along y. A column beside x gains more than that along y, but nothing is left of it beside x.
    x, y = np.eye(3)[0], np.eye(3)[1]
    told = scores(np.stack([x + 1e-9 * y, x, y], axis=1), -(3.0 * x + 2.0 * y))
    whole = told.raw

    def gains(left: Scores) -> np.ndarray:
        return gain_of(left.score, np.diag(left.gram), whole)

    assert forward(told, gains, lambda k: np.eye(3)[:, [k]], 3) in ([0, 2], [1, 2])


def test_a_column_of_which_nothing_shows_gains_nothing() -> None:
    # Truth: 0 where all of it is rounding, whatever its score; else score^2 / norm / 2.
    score, norm, whole = np.array([1e200, 3.0, 2.0]), np.array([0.0, 1e-12, 4.0]), np.array([-1e-20, 1.0, 4.0])
    with np.errstate(all="raise"):
        assert gain_of(score, norm, whole) == pytest.approx([0.0, 0.0, 0.5])
