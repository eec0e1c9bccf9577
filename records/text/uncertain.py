"""Values as text to the digits that their standard deviation warrants: two of that, and the value to the same place."""

import math

DIGITS = 2  # of a standard deviation: with one, 0.1 may stand for anything from 0.095 to 0.15; a third is noise of its own estimate
EXACT = 5  # digits of a value without one
PLAIN = (1e-4, 1e6)  # sizes written without a power of ten, in a value's own unit


def to_sd(value: float, sd: float) -> str:
    """The value to the place of the second digit of `sd`, both in one unit: "4.37" of 4.3712 with 0.22.

    What that would make zero and is none keeps two digits of its own; an `sd` that is zero or not finite leaves five digits.
    """
    return _to(value, sd, max(abs(value), sd))


def with_sd(value: float, sd: float) -> str:
    """The same, and what it may be off by: "4.37 ± 0.22"."""
    size = max(abs(value), sd)
    return f"{_to(value, sd, size)} ± {_to(sd, sd, size)}"


def interval(lower: float, upper: float, sd: float) -> str:
    """The ends of an interval of a value with this `sd`: "3.95 .. 4.80"."""
    size = max(abs(lower), abs(upper), sd)
    return f"{_to(lower, sd, size)} .. {_to(upper, sd, size)}"


def _to(value: float, sd: float, size: float) -> str:
    """To the place of `sd`; with a power of ten where the larger number beside it, `size`, needs one."""
    if not (math.isfinite(value) and math.isfinite(sd) and sd > 0.0):
        return f"{value:.{EXACT}g}"
    place = _exponent(sd, DIGITS) - (DIGITS - 1)
    rounded = round(value, -place)
    if rounded == 0.0:
        return f"{value:.{DIGITS}g}" if value else "0"
    if PLAIN[0] <= size < PLAIN[1]:
        return f"{rounded:.{max(0, -place)}f}"
    return f"{rounded:.{max(0, _exponent(rounded, 16) - place)}e}"


def _exponent(value: float, digits: int) -> int:
    """The power of ten of the first digit, once the value is rounded to so many."""
    return int(f"{abs(value):.{digits - 1}e}".partition("e")[2])
