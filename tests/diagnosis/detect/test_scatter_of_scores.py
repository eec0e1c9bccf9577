"""How much more scores scatter where innovations are alike for a while, by the sandwich of their seconds."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from diagnosis.detect.form_scores import products, scatter_of_scores
from diagnosis.detect.linearisation import Linearisation
from tests.diagnosis.arm import plain_linearisation

KEPT = 0.9  # from row to row of 10 ms: forgotten in 0.1 s, a tenth of a block


def slow_columns(count: int) -> np.ndarray:
    """Sines of periods of some seconds, of which the arm's coefficients imitate next to nothing."""
    rows = np.arange(count)[:, None]
    return np.sin(rows * np.linspace(0.011, 0.031, 40) + np.arange(40))


def scatter_with(linearisation: Linearisation, w: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """By innovations w, with the columns in two parts."""
    known, half = replace(linearisation, w=w), len(w) // 2
    parts = [(rows, columns[rows]) for rows in (np.arange(half), np.arange(half, len(w)))]
    return scatter_of_scores(known, products(known, np.zeros((len(w), 0)), parts, columns.shape[1]))


def scatter(kept: float, seeds: int) -> float:
    """The mean over forms and draws of innovations whose first correlation is `kept`."""
    linearisation = plain_linearisation()
    count = len(linearisation.w)
    columns, found = slow_columns(count), []
    for seed in range(seeds):
        white = np.random.default_rng(seed).standard_normal(count)
        w = lfilter([np.sqrt(1.0 - kept**2)], [1.0, -kept], white)
        found.append(scatter_with(linearisation, w, columns).mean())
    return float(np.mean(found))


def test_white_innovations_scatter_as_they_should() -> None:
    # 20 blocks, of which theta takes one: 0.95, known to some per cent from 40 forms of 20 draws.
    assert scatter(0.0, 20) == pytest.approx(0.95, abs=0.1)


def test_what_is_alike_for_a_while_scatters_more() -> None:
    # A slow column adds (1 + a) / (1 - a) = 19 times the variance of white noise, less what a block of ten memories cuts off: 10 %, and
    # what theta takes.
    assert scatter(KEPT, 20) == pytest.approx(0.9 * 0.95 * (1.0 + KEPT) / (1.0 - KEPT), rel=0.15)


def test_an_effect_of_its_own_form_is_no_scatter() -> None:
    # Ten standard deviations of a column's own way, evenly spread: its own part is taken out, so that its gain stays what it is.
    linearisation = plain_linearisation()
    columns = slow_columns(len(linearisation.w))
    unit = columns[:, 0] / np.linalg.norm(columns[:, 0])
    white = np.random.default_rng(3).standard_normal(len(unit))
    one, other = (scatter_with(linearisation, w, columns[:, :1])[0] for w in (white, white - 30.0 * unit))
    assert other == pytest.approx(one, rel=0.2)
