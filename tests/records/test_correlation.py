"""The section [correlation] of a plant file."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from records.correlation import Correlation
from records.errors import BadInput
from records.plant import load_plant, parse_plant, plant_text

PLANT = load_plant(Path(__file__).parents[2] / "plants" / "ce150.toml")
FOUND = Correlation(("K_M", "p_bM_2", "J_E"), ((1.0, 0.5, 0.0), (0.5, 1.0, -0.25), (0.0, -0.25, 1.0)))


def read(text):
    return parse_plant(tomllib.loads(text), "ce150", "ce150.toml")


def test_a_plant_with_a_correlation_reads_back_equal():
    plant = replace(PLANT, correlation=FOUND)
    assert read(plant_text(plant)) == plant


def test_what_the_matrix_lacks_is_independent():
    full = FOUND.spread_over(("J_E", "b_vE", "K_M"))
    np.testing.assert_array_equal(full, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    assert FOUND.spread_over(("p_bM_2", "J_E"))[0, 1] == -0.25


@pytest.mark.parametrize(
    ("names", "rows", "words"),
    [
        (["K_X"], [[1.0]], "coefficient 'K_X'"),
        (["p_bM"], [[1.0]], "coefficient 'p_bM'"),
        (["K_M", "K_M"], [[1.0, 0.0], [0.0, 1.0]], "a name twice"),
        (["K_M", "J_E"], [[1.0, 0.0]], "expected 2, one for each name"),
        (["K_M", "J_E"], [[1.0, 0.0], [0.0]], "expected 2 entries"),
        (["K_M", "J_E"], [[1.0, 0.2], [0.3, 1.0]], "correlation of J_E, K_M: got 0.3 and 0.2"),
        (["K_M", "J_E"], [[1.0, 0.2], [0.2, 0.9]], "diagonal at J_E: got 0.9, expected 1"),
        (["K_M", "J_E"], [[1.0, 1.5], [1.5, 1.0]], "an eigenvalue of -0.5"),
        (["K_M"], "none", "another number of rows"),
    ],
)
def test_no_matrix_of_correlations_is_refused(names, rows, words):
    text = plant_text(PLANT) + f"\n[correlation]\nnames = {names}\nrows = {rows!r}\n".replace("'", '"')
    with pytest.raises(BadInput) as refused:
        read(text)
    assert words in str(refused.value)
    assert "correlation" in str(refused.value)
