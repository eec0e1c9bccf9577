"""A number that rounds to zero is told without a sign, in whatever text it stands."""

import pytest

from records.text.zeros import unsigned_zeros

SAME = ["-0.01", "+1", "1e-0", "x-0", "build/-0", "2-0.0", "-0.0.1", "--0", "+10.0", "-00:30", "0.00", "a - 0", "-0x1"]


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ("-0.00 %", "0.00 %"),
        ("+0.000 rad", "0.000 rad"),
        ("-0", "0"),
        ("-0.00e+00 V", "0.00e+00 V"),
        ("[-0.0, +0.05]", "[0.0, +0.05]"),
        ("between -0.000 and -0.001", "between 0.000 and -0.001"),
        ("-0.000 + 0.120i", "0.000 + 0.120i"),
        *((text, text) for text in SAME),
    ],
)
def test_a_zero_loses_its_sign_and_nothing_else_does(told: str, expected: str) -> None:
    assert unsigned_zeros(told) == expected
