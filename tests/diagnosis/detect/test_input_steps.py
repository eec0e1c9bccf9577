"""Errors of an input by steps, as the C of all steps side by side has them."""

import numpy as np
import pytest

from diagnosis.detect.input_steps import Kind, _Sent, _sums, errors_of
from sim.paths.path import in_held_steps

KINDS = [Kind(hold, shift) for hold in (0.0, 0.12) for shift in (0.0, 0.25, 0.5, -0.25)]


def commands(count: int) -> np.ndarray:
    """A walk, which passes steps one by one, with leaps over many."""
    rng = np.random.default_rng(3)
    return np.cumsum(rng.normal(0.0, 0.02, count)) + 1.5 * (rng.random(count) < 0.02)


@pytest.mark.parametrize("step", [0.01, 0.3])
def test_an_error_is_what_the_stage_of_that_kind_takes(step: float) -> None:
    # Truth: the plant's own stage, of a command that lies so much of a step further.
    u = commands(400)
    found = errors_of(u, np.full(len(KINDS), step), KINDS)
    for kind, errors in zip(KINDS, found.T, strict=True):
        shifted = u + kind.shift * step
        held, _ = in_held_steps(shifted, step, kind.hold, None)
        assert errors == pytest.approx((shifted - held) / step, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_sums_are_those_of_the_errors(kind: Kind) -> None:
    u, rng = commands(300), np.random.default_rng(4)
    pull, square, steps = rng.normal(size=300), rng.random(300), np.geomspace(0.01, 0.3, 37)
    errors = errors_of(u, steps, [kind] * len(steps))
    score, squares = _sums(_Sent(u, pull, square), steps, kind)
    assert score == pytest.approx(-pull @ errors, rel=1e-9)
    assert squares == pytest.approx(square @ errors**2, rel=1e-9)
