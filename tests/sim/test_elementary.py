"""The kernels' own sine and cosine."""

from pathlib import Path

import mpmath
import numpy as np
import pytest

import sim
from sim.kernel.sincos import sincos_header
from toolchain.host import FAST_FLAGS, CText, build_shared, load_shared

C_DIR = Path(sim.__file__).parent / "kernel" / "c"
RELATIVE = 2e-16

DRIVER = """
#define LANES {lanes}
#include "sincos.h"
void sincos_{lanes}(int count, const double *angle, double *sine, double *cosine)
{{
    for (int i = 0; i < count; i += LANES) {{
        num a = NUM(0.0), s, c;
        for (int lane = 0; lane < LANES; lane++)
            lane_set(&a, lane, angle[i + lane]);
        lane_sincos(a, &s, &c);
        for (int lane = 0; lane < LANES; lane++) {{
            sine[i + lane] = lane_get(s, lane);
            cosine[i + lane] = lane_get(c, lane);
        }}
    }}
}}
"""


@pytest.fixture(scope="module")
def sincos():
    header = CText("sincos_coefficients.h", sincos_header())
    functions = {}
    for lanes in (1, 8):
        source = CText("driver.c", DRIVER.format(lanes=lanes))
        path = build_shared("sincos", [source, header], include_dirs=[C_DIR], flags=FAST_FLAGS)
        ffi, lib = load_shared(f"void sincos_{lanes}(int, const double *, double *, double *);", path)
        functions[lanes] = (ffi, getattr(lib, f"sincos_{lanes}"))

    def call(lanes, angle):
        ffi, function = functions[lanes]
        sine, cosine = np.empty_like(angle), np.empty_like(angle)
        function(angle.size, *(ffi.cast("double *", array.ctypes.data) for array in (angle, sine, cosine)))
        return sine, cosine

    return call


RANDOM = np.random.default_rng(0)
ANGLES = {
    "within the stops": RANDOM.uniform(-0.8, 0.8, 2000),
    "azimuth": RANDOM.uniform(-2.5, 2.5, 2000),
    "many turns": RANDOM.uniform(-1e5, 1e5, 800),
    "beyond reduction": RANDOM.uniform(-1e12, 1e12, 400),
    "next to the zeros": np.arange(1, 801) * (np.pi / 2),
    "tiny": RANDOM.uniform(-1, 1, 80) * 1e-9,
}


@pytest.mark.parametrize("where", ANGLES)
def test_error_is_below_2e_16_relative_and_the_same_in_all_lanes(sincos, where):
    angles = ANGLES[where]
    one, many = sincos(1, angles), sincos(8, angles)
    assert np.array_equal(one, many)
    with mpmath.workdps(60):
        for found, exact in zip(one, (mpmath.sin, mpmath.cos), strict=True):
            errors = [
                abs(mpmath.mpf(float(f)) / exact(mpmath.mpf(float(a))) - 1) for f, a in zip(found, angles, strict=True)
            ]
            assert max(errors) < RELATIVE


def test_zero_infinity_and_nan_are_as_in_libm(sincos):
    angles = np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 1e-310, 0.8, -0.8000000001])
    sine, cosine = sincos(8, angles)
    np.testing.assert_array_equal(np.isnan(sine), [False, False, True, True, True, False, False, False])
    np.testing.assert_array_equal(sine[:2], [0.0, 0.0])
    np.testing.assert_array_equal(cosine[:2], [1.0, 1.0])
    assert sine[5] == 1e-310
