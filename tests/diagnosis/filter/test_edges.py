"""What a count that changes says of the output: as near as it claims, nearer than the count, and nothing where noise moves the counts."""

import numpy as np
import pytest

from diagnosis.filter.edges import sharpened

STEP = 1.5e-3
ROUNDING = STEP**2 / 12.0


def read(way: np.ndarray) -> np.ndarray:
    return STEP * np.round(way / STEP)


@pytest.mark.parametrize("speed_rad_s", [0.005, 0.02, 0.05])
def test_an_edge_is_as_near_as_it_claims(speed_rad_s: float) -> None:
    # A swing of that peak speed: the errors' mean square is that stated, 0.75 to 1.1 of it (an output is slower than the shorter count
    # allows), and less than half of rounding's rms. They lead or lag by less than 0.2 ms, which is what a sensor's delay is told by.
    t_s = 0.01 * np.arange(12000)
    way = 0.4 + speed_rad_s / 0.7 * np.sin(0.7 * t_s)
    y, r = sharpened(t_s, read(way), np.full(len(way), ROUNDING), STEP)
    sharp = r < ROUNDING
    edges = np.flatnonzero(np.diff(read(way))) + 1
    assert sharp.sum() > 0.9 * len(edges)
    assert set(np.flatnonzero(sharp)) <= set(edges)
    whitened = (y - way)[sharp] / np.sqrt(r[sharp])
    assert 0.75 < np.mean(whitened**2) < 1.1
    assert np.sqrt(np.mean((y - way)[sharp] ** 2)) < 0.5 * np.sqrt(ROUNDING)
    speed = speed_rad_s * np.cos(0.7 * t_s)[sharp]
    lead_s = np.sum((y - way)[sharp] * speed / r[sharp]) / np.sum(speed**2 / r[sharp])
    assert abs(lead_s) < 0.2e-3
    assert np.array_equal(y[~sharp], read(way)[~sharp])


@pytest.mark.parametrize("noise_counts", [0.05, 0.1, 0.3, 1.0])
def test_where_noise_moves_the_counts_they_stay_as_they_are(noise_counts: float) -> None:
    # Noise over a slow way: changes are undone at once, and tell nothing of when an edge was passed.
    rng = np.random.default_rng(4)
    t_s = 0.01 * np.arange(6000)
    way = 0.05 * np.sin(0.5 * t_s)
    noisy = read(way + noise_counts * STEP * rng.standard_normal(6000))
    y, r = sharpened(t_s, noisy, np.full(6000, ROUNDING), STEP)
    assert y is noisy
    assert (r == ROUNDING).all()


def test_jumps_and_gaps_are_no_edges() -> None:
    # Two counts at once, and one count over missing rows: when the edge was passed is not known.
    t_s = np.delete(0.01 * np.arange(60), np.arange(21, 30))
    y = STEP * np.repeat([0.0, 2.0, 3.0, 4.0], [10, 11, 10, 20])
    _, r = sharpened(t_s, y, np.full(51, ROUNDING), STEP)
    assert np.flatnonzero(r < ROUNDING).tolist() == [31]


def test_a_reading_without_steps_stays() -> None:
    y, r = np.linspace(0.0, 1.0, 50), np.ones(50)
    found = sharpened(0.01 * np.arange(50), y, r, 0.0)
    assert found[0] is y
    assert found[1] is r
