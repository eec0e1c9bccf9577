/* Sine and cosine together, without branches per lane.
 *
 * |a| <= SINCOS_DIRECT: polynomials in a^2 (coefficients: sim/kernel/sincos.py), error below 2e-16 relative. Beyond, the nearest multiple of
 * pi/2 is taken off in three parts of 33, 33 and 53 bits, with the rounding carried along; from SINCOS_REDUCED on, libm.
 */
#ifndef SINCOS_H
#define SINCOS_H

#include "lane.h"
#include "sincos_coefficients.h"

/* sin(a + tail) and cos(a + tail) for |a| <= SINCOS_DIRECT and |tail| below the last bit of a. */
ALWAYS_INLINE void sincos_direct(num a, num tail, num *sine, num *cosine)
{
    const num z = a * a, z2 = z * z, z4 = z2 * z2;
    const num s = (NUM(SIN_0) + NUM(SIN_1) * z) + z2 * (NUM(SIN_2) + NUM(SIN_3) * z) + z4 * (NUM(SIN_4) + NUM(SIN_5) * z);
    const num c = (NUM(COS_0) + NUM(COS_1) * z) + z2 * (NUM(COS_2) + NUM(COS_3) * z) + z4 * (NUM(COS_4) + NUM(COS_5) * z);
    const num half = NUM(0.5) * z;
    const num lead = NUM(1.0) - half;
    *sine = a + (a * (z * s) + tail * lead);
    *cosine = lead + (((NUM(1.0) - lead) - half) + (z2 * c - a * tail));
}

static inline void sincos_reduced(num a, num *sine, num *cosine)
{
    const mask direct = is_less_equal(lane_abs(a), NUM(SINCOS_DIRECT));
    const num turns = select(direct, NUM(0.0), lane_round(a * NUM(TWO_OVER_PI)));
    const num first = a - turns * NUM(HALF_PI_1);
    const num second = turns * NUM(HALF_PI_2);
    const num r = first - second;
    const num back = r - first;
    const num lost = (first - (r - back)) - (second + back);
    const num tail = select(direct, NUM(0.0), lost - turns * NUM(HALF_PI_3));
    num s, c;
    sincos_direct(r, tail, &s, &c);
    const num pairs = lane_round(turns * NUM(0.5) - NUM(0.25)); /* floor(turns / 2) */
    const num odd = turns - NUM(2.0) * pairs;
    const num halves = pairs - NUM(2.0) * lane_round(pairs * NUM(0.5) - NUM(0.25));
    const mask swap = is_less(NUM(0.5), odd);
    const num flip = NUM(1.0) - NUM(2.0) * halves;
    *sine = flip * select(swap, c, s);
    *cosine = flip * select(swap, -s, c);
}

ALWAYS_INLINE void lane_sincos(num a, num *sine, num *cosine)
{
    if (all(is_less_equal(lane_abs(a), NUM(SINCOS_DIRECT)))) {
        sincos_direct(a, NUM(0.0), sine, cosine);
        return;
    }
    sincos_reduced(a, sine, cosine);
    for (int lane = 0; lane < LANES; lane++) {
        const double angle = lane_get(a, lane);
        if (!(fabs(angle) < SINCOS_REDUCED)) {
            lane_set(sine, lane, sin(angle));
            lane_set(cosine, lane, cos(angle));
        }
    }
}

#endif
