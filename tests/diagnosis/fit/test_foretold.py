"""What the past of innovations foretells: nothing of white ones, of coloured ones what an autoregression of them gains."""

import numpy as np
import pytest

from diagnosis.filter.kalman import Pass
from diagnosis.fit.foretold import foretold_nats, rescaled_nats

ROWS = 20000
EMPTY = np.zeros((0, 0))


def a_pass(w: np.ndarray) -> Pass:
    return Pass(w, np.ones_like(w), None, EMPTY, EMPTY, 0.0, EMPTY, np.zeros(0), np.zeros(0), EMPTY)


def test_white_innovations_foretell_nothing_beyond_chance() -> None:
    """Truth: 0; the 22 numbers of two outputs' blocks scatter by the root of half of 44 nats."""
    w = np.random.default_rng(1).normal(size=(ROWS, 2))
    assert foretold_nats([a_pass(w)]) == pytest.approx(0.0, abs=4.0 * np.sqrt(22.0))


def test_an_autoregression_gains_what_its_law_says() -> None:
    """Truth: w_t = 0.3 w_{t-1} + e_t has -n / 2 ln(1 - 0.3^2) nats in it, told to 5 % by so many rows; of two runs twice as much."""
    e = np.random.default_rng(2).normal(size=ROWS)
    w = np.zeros(ROWS)
    for t in range(1, ROWS):
        w[t] = 0.3 * w[t - 1] + e[t]
    truth = -0.5 * ROWS * np.log(1.0 - 0.3**2)
    assert foretold_nats([a_pass(w[:, None])]) == pytest.approx(truth, rel=0.05)
    assert foretold_nats([a_pass(w[:, None])] * 2) == pytest.approx(2.0 * truth, rel=0.05)


def test_what_is_alike_for_hundreds_of_rows_is_foretold_though_little_in_each() -> None:
    """Truth: what comes and goes over 200 rows, 0.3 of the white part; between a third and all of what its being known would gain,
    n / 2 ln(1 + 0.3^2)."""
    rng = np.random.default_rng(3)
    slow = np.zeros(ROWS)
    kept = np.exp(-1.0 / 200.0)
    for t in range(1, ROWS):
        slow[t] = kept * slow[t - 1] + np.sqrt(1.0 - kept**2) * rng.normal()
    gained = foretold_nats([a_pass((rng.normal(size=ROWS) + 0.3 * slow)[:, None])])
    known = 0.5 * ROWS * np.log(1.0 + 0.3**2)
    assert known / 3.0 < gained < known


def test_what_was_never_read_or_not_yet_does_no_harm() -> None:
    w = np.random.default_rng(4).normal(size=(ROWS, 2))
    w[:, 1] = np.nan
    w[:100, 0] = np.nan
    assert foretold_nats([a_pass(w)]) == pytest.approx(0.0, abs=20.0)
    assert foretold_nats([a_pass(np.full((50, 2), np.nan))]) == 0.0


def test_innovations_that_are_larger_or_smaller_than_told_gain_by_noise_of_their_size() -> None:
    """Truth: of w ~ N(0, s) over n readings n / 2 (s - 1 - ln s), of each output by itself; to 5 %, what so many rows tell."""
    w = np.random.default_rng(5).normal(size=(ROWS, 2)) * [1.5, 0.7]
    w[::2, 1] = np.nan
    truth = sum(0.5 * n * (s - 1.0 - np.log(s)) for n, s in ((ROWS, 2.25), (ROWS / 2, 0.49)))
    assert rescaled_nats([a_pass(w[:500]), a_pass(w[500:])]) == pytest.approx(truth, rel=0.05)
    assert rescaled_nats([a_pass(w / [1.5, 0.7])]) == pytest.approx(0.0, abs=5.0)
    assert rescaled_nats([a_pass(np.full((50, 2), np.nan))]) == 0.0
