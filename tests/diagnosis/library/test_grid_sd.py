"""What is known of a coarse grid's step: what the rounding of its ends leaves."""

import numpy as np
import pytest

from diagnosis.library.coarse_grid import coarse_step, grid_sd

COUNT = 2.0 * np.pi / 4096
RUNS = 60


@pytest.mark.parametrize("span_rad", [0.7, 2.5])
def test_the_step_that_is_found_lies_within_its_deviations(span_rad: float) -> None:
    # Truth: grids of 20 to 40 counts that are read to a count. Of 60 no more than one in ten is off by two deviations and more, and in the
    # mean square they are off by a fifth of one and more.
    rng = np.random.default_rng(5)
    off = []
    for _ in range(RUNS):
        grid = rng.uniform(20.0, 40.0) * COUNT
        angle = 0.5 * span_rad * np.sin(np.linspace(0.0, 40.0, 8000) + rng.uniform(0.0, 6.0)) + rng.uniform(-1.0, 1.0)
        read = COUNT * np.round(grid * np.round(angle / grid) / COUNT)
        found = coarse_step(read, COUNT)
        assert found is not None
        off.append(abs(found - grid) / grid_sd(read, found, COUNT))
    assert np.mean(np.array(off) > 2.0) <= 0.1
    assert np.sqrt(np.mean(np.square(off))) > 0.2
