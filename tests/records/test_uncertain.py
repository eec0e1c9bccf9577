"""Values to the digits that their standard deviation warrants: two of that, the value to the same place."""

import math

import pytest

from records.text.uncertain import interval, to_sd, with_sd


@pytest.mark.parametrize(
    ("value", "sd", "told"),
    [
        (4.3712, 0.22, "4.37 ± 0.22"),
        (0.00437123, 0.00022, "0.00437 ± 0.00022"),
        (0.0029893, 5.8e-5, "0.002989 ± 0.000058"),
        (12345.0, 123.0, "12340 ± 120"),
        (5.0, 0.1, "5.00 ± 0.10"),
        (1.0, 0.0996, "1.00 ± 0.10"),  # an sd that rounds up into the next place
        (1.2346e-7, 2e-9, "1.235e-07 ± 2.0e-09"),
        (9.996e-5, 1.2e-6, "1.000e-04 ± 1.2e-06"),
        (123456789.0, 2.2e6, "1.235e+08 ± 2.2e+06"),
        (-0.5, 0.013, "-0.500 ± 0.013"),
    ],
)
def test_two_digits_of_the_sd_and_the_value_to_the_same_place(value: float, sd: float, told: str) -> None:
    assert with_sd(value, sd) == told
    assert to_sd(value, sd) == told.partition(" ")[0]


@pytest.mark.parametrize("value", [math.pi * 10.0**power for power in range(-12, 12)])
@pytest.mark.parametrize("sd", [10.0**-power * 1.7 for power in range(6)])
def test_what_is_told_is_the_value_within_a_twentieth_of_its_sd(value: float, sd: float) -> None:
    # Half a unit of the sd's second digit is at most a twentieth of the sd.
    assert float(to_sd(value, sd * value)) == pytest.approx(value, abs=0.05 * sd * value)


def test_an_end_or_a_value_far_below_its_sd_is_not_told_as_zero() -> None:
    assert interval(0.000234, 0.5, 0.02) == "0.00023 .. 0.500"
    assert to_sd(0.000312, 0.012) == "0.00031"


def test_an_interval_that_ends_at_zero_does() -> None:
    assert interval(0.0, 5e-5, 1.2e-5) == "0 .. 5.0e-05"


@pytest.mark.parametrize("sd", [0.0, math.nan, math.inf])
def test_a_value_without_an_sd_keeps_five_digits(sd: float) -> None:
    assert to_sd(9.80665432, sd) == "9.8067"
