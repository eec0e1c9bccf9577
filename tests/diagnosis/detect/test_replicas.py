"""What a log without a gap would show: the law of largest gains, and innovations as white as the log's own."""

import numpy as np
import pytest

from diagnosis.detect.replicas import REPLICAS, replicas, tail_of
from tests.diagnosis.arm import plain_linearisation


def test_the_law_of_largest_gains_is_found_from_draws_of_it() -> None:
    # Truth: place 5 and scale 2, of which 50 000 draws tell both to a hundredth or two; so the chance of its 95 % quantile is 5 %.
    tail = tail_of(np.random.default_rng(1).gumbel(5.0, 2.0, 50_000))
    assert (tail.place, tail.scale) == (pytest.approx(5.0, abs=0.05), pytest.approx(2.0, abs=0.05))
    assert tail.probability(5.0 - 2.0 * np.log(-np.log(0.95))) == pytest.approx(0.05, abs=0.003)


def test_gains_that_are_all_alike_make_no_law_without_width() -> None:
    tail = tail_of(np.full(REPLICAS, 3.0))
    assert tail.scale == 0.5
    assert 0.4 < tail.probability(3.0) < 0.6


def test_replicas_scatter_as_the_log_does_but_for_what_the_parameters_do() -> None:
    # Truth: the log has no gap, so its own innovations are one replica more: their variance to a tenth, and none remembers the one before.
    linearisation = plain_linearisation()
    drawn, slopes = replicas(linearisation), linearisation.slopes
    assert drawn.shape == (linearisation.w.size, REPLICAS)
    left = drawn - slopes @ np.linalg.lstsq(slopes, drawn, rcond=None)[0]
    assert np.var(left) == pytest.approx(np.var(linearisation.w), rel=0.1)
    assert abs(np.mean(left[1:] * left[:-1])) < 0.05


def test_replicas_are_drawn_alike_each_time() -> None:
    linearisation = plain_linearisation()
    assert np.array_equal(replicas(linearisation), replicas(linearisation))
