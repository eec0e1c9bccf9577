"""The last cell of a text without a last line end: what is surely whole stays, what may have lost digits does not."""

import pytest

from records.text.last_row import may_be_cut

DOUBLES = ["0.12207031250000001", "0.1226043701171875", "0.123"]  # the shortest texts that give a double back
SIX_DIGITS = ["9.87654", "10.1235", "10.5"]  # %.6g
COUNTS = ["1021", "1034", "1046"]
SMALL = ["0.00012", "9.5e-05", "0.00011"]


@pytest.mark.parametrize(
    ("above", "last"),
    [
        (DOUBLES, "0.12313842773437"),  # enough digits to tell a float32, whatever was lost
        (DOUBLES, "0.123"),  # repeats the one above
        (SIX_DIGITS, "11.0123"),  # as many digits as any, and fewer decimals
        (COUNTS, "1058"),
        (["3", "0", "1"], "0"),
        (SMALL, "9.1e-05"),
        (["1.25e+00", "1.50e+00"], "1.75e+00"),
        (["1.25 V", "1.5 V"], "1 V"),  # a unit stands behind
        (["0.1", "nan", "0.3"], "0.2"),
        ([], "0.1"),  # nobody knows
    ],
)
def test_a_last_number_that_is_whole_is_known_as_that(above: list[str], last: str) -> None:
    assert not may_be_cut(last, above)


@pytest.mark.parametrize(
    ("above", "last"),
    [
        (DOUBLES, "0.12313842"),  # 8 digits of a float32
        (SIX_DIGITS, "11.012"),
        (COUNTS, "105"),
        (COUNTS, "1"),
        (SMALL, "9.1"),
        (["0.00012", "0.00011"], "9.1"),  # the first exponent
        (SMALL, "9.1e-0"),
        (["1.25e+00", "1.50e+00"], "1.75"),
        (["1.25 V", "1.5 V"], "1.7"),
        (["0.25", "0.5"], "0."),
    ],
)
def test_a_last_number_that_may_have_lost_digits_is_known_as_that(above: list[str], last: str) -> None:
    assert may_be_cut(last, above)


def test_a_decimal_comma_separates_decimals_too() -> None:
    assert may_be_cut("0,1", ["0,125", "0,250"], ",")
    assert not may_be_cut("0,375", ["0,125", "0,250"], ",")
