"""Numbers as tables show them."""

import pytest

from records.text.units import coherent, digits, dimension, plain_unit


@pytest.mark.parametrize(
    ("value", "shown"),
    [(-3.25, "-3.25"), (-14.857, "-14.86"), (-0.0454, "-0.0454"), (-0.04, "-0.0400"), (-0.5, "-0.500"), (0.0, "0.00")],
)
def test_a_table_s_number_has_two_decimals_and_three_digits_at_least(value: float, shown: str) -> None:
    """Truth: -0.045 and -0.0454 rad/s, of a heater, are not -0.04 and -0.05."""
    assert digits(value) == shown


@pytest.mark.parametrize(
    ("suffix", "unit"),
    [("rad", "rad"), ("rad_s2", "rad s^-2"), ("K_s", "K/s"), ("Nm", "N m"), ("m3_s", "m^3/s"), ("kg_s", "kg s^-1")],
)
def test_a_column_s_ending_is_a_unit(suffix: str, unit: str) -> None:
    assert dimension(coherent(suffix)) == dimension(unit)


@pytest.mark.parametrize(
    ("unit", "said"), [("1", ""), ("-", ""), ("1 s^-1", "s^-1"), ("N m", "N m"), ("rad rad^-1", "per rad")]
)
def test_a_number_without_a_unit_is_said_without_one(unit: str, said: str) -> None:
    """Truth: the offset of a valve's opening is 0.02, and its rate 0.15 s^-1."""
    assert plain_unit(unit) == said
