"""Coefficients of the kernels' own sine and cosine, interpolated at Chebyshev points in many digits when a kernel is generated."""

from collections.abc import Callable
from functools import cache

import mpmath

DIRECT_RAD = 0.8  # a little over pi/4, so that stages just beyond a stop at 45 deg still go the short way
REDUCED_RAD = 1.0e5
COEFFICIENTS = 6
WORKING_DIGITS = 60


@cache
def sincos_header() -> str:
    """C text of the constants that sim/kernel/c/sincos.h needs.

    sin a = a + a z S(z), cos a = 1 - z/2 + z^2 C(z), z = a^2; S and C interpolate at 6 Chebyshev points of [0, DIRECT_RAD^2], which
    leaves 2e-17 relative, well below the rounding of a double.
    """
    with mpmath.workdps(WORKING_DIGITS):
        sine = _interpolated(lambda z: (mpmath.sin(mpmath.sqrt(z)) / mpmath.sqrt(z) - 1) / z)
        cosine = _interpolated(lambda z: (mpmath.cos(mpmath.sqrt(z)) - 1 + z / 2) / z**2)
        first, second, third = _half_pi_parts()
        two_over_pi = float(2 / mpmath.pi)
    values = {f"SIN_{index}": value for index, value in enumerate(sine)}
    values |= {f"COS_{index}": value for index, value in enumerate(cosine)}
    values |= {"HALF_PI_1": first, "HALF_PI_2": second, "HALF_PI_3": third, "TWO_OVER_PI": two_over_pi}
    values |= {"SINCOS_DIRECT": DIRECT_RAD, "SINCOS_REDUCED": REDUCED_RAD}
    return "".join(f"#define {name} {value!r}\n" for name, value in values.items())


def _interpolated(function: Callable[[mpmath.mpf], mpmath.mpf]) -> tuple[float, ...]:
    """Coefficients in ascending powers of the polynomial through `function` at the Chebyshev points."""
    width = mpmath.mpf(DIRECT_RAD) ** 2
    angles = [mpmath.pi * (2 * index + 1) / (2 * COEFFICIENTS) for index in range(COEFFICIENTS)]
    points = [width * (1 + mpmath.cos(angle)) / 2 for angle in angles]
    vandermonde = mpmath.matrix([[point**power for power in range(COEFFICIENTS)] for point in points])
    solution = mpmath.lu_solve(vandermonde, mpmath.matrix([function(point) for point in points]))
    return tuple(float(value) for value in solution)


def _half_pi_parts() -> tuple[float, float, float]:
    """pi/2 as a sum of two parts of 33 bits, exact when multiplied by a small integer, and the rest."""
    rest, parts = mpmath.pi / 2, []
    for _ in range(2):
        unit = mpmath.mpf(2) ** (mpmath.floor(mpmath.log(rest, 2)) - 32)
        part = mpmath.floor(rest / unit) * unit
        parts.append(float(part))
        rest -= part
    return parts[0], parts[1], float(rest)
