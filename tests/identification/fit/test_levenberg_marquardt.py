"""Truth: Rosenbrock's valley, least squares whose minimum is (1, 1), and schedules that are written down in their papers."""

from dataclasses import dataclass
from itertools import islice

import numpy as np
import pytest

from identification.fit.levenberg_marquardt import FIRST, LEAST, MARQUARDT, MOST, NIELSEN, trials
from tests.identification.fit.valley import valley


@dataclass(frozen=True, eq=False)
class At:
    x: np.ndarray
    cost: float


def moved(point, mu):
    x, r = point.x, valley(point.x)
    J = np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])
    H = J.T @ J
    x = x - np.linalg.solve(H + mu * np.diag(np.diag(H)), J.T @ r)
    return At(x, float(valley(x) @ valley(x)))


@pytest.mark.parametrize("schedule", [MARQUARDT, NIELSEN])
def test_the_curved_valley_is_followed_to_its_end(schedule):
    start = np.array([-1.2, 1.0])
    better = [point for point in islice(trials(At(start, 24.2), moved, schedule), 60) if point is not None]
    assert better[-1].x == pytest.approx([1.0, 1.0], abs=1e-6)
    assert np.all(np.diff([24.2, *(point.cost for point in better)]) < 0.0)


def dampings(schedule, costs):
    """The mu of each trial, where the trials cost so much one after the other from a start at 1."""
    asked, left = [], iter(costs)

    def move(_, mu):
        asked.append(mu)
        cost = next(left, None)
        return None if cost is None else At(np.zeros(0), cost)

    found = list(trials(At(np.zeros(0), 1.0), move, schedule))
    return asked, [None if point is None else point.cost for point in found]


def test_marquardt_s_damping_goes_by_tens_and_nielsen_s_ever_faster_up_and_by_threes_down():
    costs = [2.0, 2.0, 0.5, 1.0, np.inf, 0.25]
    told = [None, None, 0.5, None, None, 0.25]
    asked, found = dampings(MARQUARDT, costs)
    assert found == told
    assert asked == pytest.approx(FIRST * np.array([1.0, 10.0, 100.0, 10.0, 100.0, 1000.0, 100.0]))
    asked, found = dampings(NIELSEN, costs)
    assert found == told
    assert asked == pytest.approx(FIRST * np.array([1.0, 2.0, 8.0, 8.0 / 3.0, 16.0 / 3.0, 64.0 / 3.0, 64.0 / 9.0]))


def test_a_step_too_short_to_count_ends_it_and_so_does_a_damping_that_leaves_nothing_of_a_step():
    assert dampings(MARQUARDT, [])[1] == []
    asked, found = dampings(MARQUARDT, [2.0] * 100)
    assert found == [None] * len(asked)
    assert max(asked) == pytest.approx(MOST / 10.0)
    asked, _ = dampings(MARQUARDT, list(1.0 / np.arange(2.0, 22.0)))
    assert min(asked) == LEAST
