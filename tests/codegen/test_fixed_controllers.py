"""The controllers of the fixed-point words against the table's polynomials, from which its poles and margins are computed."""

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval

from codegen.fixed.controllers import fixed_controllers
from design.analysis.rounding import FLOAT32
from records.errors import BadInput
from records.table import changed_axis
from tests.law_tables import ce150_table

PSI_RAD = np.linspace(-0.6, 0.6, 41)


@pytest.mark.parametrize("axis", ["elevation", "azimuth"])
def test_each_coefficient_is_the_tables_to_a_millionth_of_its_largest_value(axis: str) -> None:
    """Truth: polynomials of the table in double precision; the words are not those numbers, and float32's are others again."""
    table = ce150_table()
    law = {"elevation": table.axes[0], "azimuth": table.axes[1]}[axis]
    found, rounded = fixed_controllers(table, axis, PSI_RAD), FLOAT32.controllers(table, axis, PSI_RAD)
    for letter, polynomials in (("q", law.q_V_rad), ("p", law.p)):
        true = np.array([polyval(PSI_RAD, row) for row in polynomials]).T
        words, floats = (np.array([getattr(form, letter) for form in forms]) for forms in (found, rounded))
        assert np.all(np.abs(words - true).max(axis=0) <= 1e-6 * np.abs(true).max())
        assert not np.array_equal(words, true)
        assert not np.array_equal(words, floats)


def test_integral_action_stays_exact() -> None:
    table = ce150_table()
    assert all(form.p[0] == 0.0 for form in fixed_controllers(table, "elevation", PSI_RAD))


def test_a_table_without_a_law_in_words_is_refused() -> None:
    table = ce150_table()
    steep = changed_axis(table, "elevation", q_V_rad=((1e5,), *table.axes[0].q_V_rad[1:]))
    with pytest.raises(BadInput, match="--arithmetic float32"):
        fixed_controllers(steep, "elevation", PSI_RAD)
