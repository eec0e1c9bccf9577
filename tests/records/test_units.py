"""Numbers as tables show them."""

import pytest

from records.text.units import digits


@pytest.mark.parametrize(
    ("value", "shown"),
    [(-3.25, "-3.25"), (-14.857, "-14.86"), (-0.0454, "-0.0454"), (-0.04, "-0.0400"), (-0.5, "-0.500"), (0.0, "0.00")],
)
def test_a_table_s_number_has_two_decimals_and_three_digits_at_least(value: float, shown: str) -> None:
    """Truth: -0.045 and -0.0454 rad/s, of a heater, are not -0.04 and -0.05."""
    assert digits(value) == shown
