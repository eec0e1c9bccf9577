"""Windows of predictions: a plant's own seconds, and less of a fast plant's log that is shorter than one."""

import numpy as np
import pytest

from diagnosis.validate.prediction import settled_after_s, windows


@pytest.mark.parametrize(
    ("rows", "period_s", "second_s", "settled_s", "edges"),
    [
        (3001, 0.01, 1.0, 2.0, [0, 100, 200]),  # half a minute of the helicopter: windows of a second behind two
        (151, 0.01, 1.0, 2.0, [0, 100]),  # a second and a half of it: not settled before it ends
        (
            5001,
            1e-4,
            1.0,
            1.0 / 3.0,
            [0, 1667, 3334],
        ),  # half a second of a motor: a sixth of it each, behind two thirds
        (3001, 0.32, 32.0, 64.0, [0, 100, 200]),  # a quarter of an hour of a heated body, whose second takes 32 s
        (3001, 0.01, 32.0, 20.0, [0, 1000, 2000]),  # half a minute of it: as of a motor
    ],
)
def test_windows_and_settling_are_of_the_rows_that_a_log_has(
    rows: int, period_s: float, second_s: float, settled_s: float, edges: list[int]
) -> None:
    t_s = period_s * np.arange(rows)
    assert settled_after_s(t_s, second_s) == pytest.approx(settled_s)
    assert [first for first, _ in windows(t_s, second_s)][: len(edges)] == edges
