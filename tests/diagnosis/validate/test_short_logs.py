"""Predictions of logs that are shorter than a window: a fast plant's are made, a slow plant's are not."""

import numpy as np
import pytest

from diagnosis.validate.prediction import settled_after_s, windows


@pytest.mark.parametrize(
    ("rows", "period_s", "settled_s", "edges"),
    [
        (3001, 0.01, 2.0, [0, 100, 200]),  # half a minute of the helicopter: windows of a second behind two
        (151, 0.01, 2.0, [0, 100]),  # a second and a half of it: not settled before it ends
        (5001, 1e-4, 1.0 / 3.0, [0, 1667, 3334]),  # half a second of a motor: a sixth of it each, behind two thirds
    ],
)
def test_windows_and_settling_are_of_the_rows_that_a_log_has(
    rows: int, period_s: float, settled_s: float, edges: list[int]
) -> None:
    t_s = period_s * np.arange(rows)
    assert settled_after_s(t_s) == pytest.approx(settled_s)
    assert [first for first, _ in windows(t_s)][: len(edges)] == edges
