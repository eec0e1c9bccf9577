"""Where an event of friction is looked for within a step."""

from pathlib import Path

import sim
from sim.bind import BoundPlant
from sim.kernel.generate import model_header
from sim.kernel.sincos import sincos_header
from tests.plants import bound
from toolchain.host import FAST_FLAGS, CText, build_shared, load_shared

C_DIR = Path(sim.__file__).parent / "kernel" / "c"
COUNTED = """
static int asked;
#define model_rates(...) (asked++, model_rates(__VA_ARGS__))
"""
DRIVER = """
#define LANES 1
#include "margin.h"

/* The plant stands, and what pushes it back wins at once: how often the equations are asked until that is known. */
int asked_until_known(const double *p, const double *x, double h_s, double *left)
{
    const double u[N_INPUTS] = {0.0};
    double c[N_CONSTANTS], early = 0.0;
    moment at = {.u = u, .c = c};
    model_constants(p, c);
    for (int i = 0; i < N_STATES; i++)
        at.body.x[i] = x[i];
    at.body.sign[0] = at.body.move[0] = 1.0;
    *left = h_s;
    asked = 0;
    return leave_zero(&at, 0.0, &early, left, 0, EVENT_REST) ? -1 : asked;
}
"""


def test_an_axis_that_is_pushed_back_as_it_breaks_away_is_known_to_rest_after_eighty_halvings() -> None:
    # Truth: friction alone acts on a carriage that stands and is taken to slide, so that its speed is past 0 however soon. 2^-80 of a
    # step, 1e-24, is as late as anything is looked for, at four asks of the equations a trial; then it is past at once.
    carriage: BoundPlant = bound("emps")
    headers = CText("model.h", model_header(carriage.model) + COUNTED), CText("sincos_coefficients.h", sincos_header())
    source = CText("driver.c", DRIVER)
    flags = (*FAST_FLAGS, "-DMODEL_CODE=static __attribute__((unused))")
    path = build_shared("margin", [source, *headers], include_dirs=[C_DIR], flags=flags)
    ffi, lib = load_shared("int asked_until_known(const double *, const double *, double, double *);", path)
    left_s = ffi.new("double *")
    asked = lib.asked_until_known(
        ffi.new("double[]", carriage.p.tolist()), ffi.new("double[]", [0.0, 0.0]), 0.01, left_s
    )
    assert 0 < asked <= 4 * 81
    assert 0.0 < left_s[0] < 1e-300
