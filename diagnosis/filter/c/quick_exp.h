/* The exponential function without a call, for a filter that asks for some thirty of them a step.
 *
 * e^x = 2^n e^r with n the integer nearest to x / ln 2 and |r| <= ln 2 / 2, where the Taylor polynomial of degree 13 is off by less than
 * 1e-17. Within 1e-15 of e^x for |x| <= 700; beyond, the value at 700. */
#ifndef QUICK_EXP_H
#define QUICK_EXP_H

#include <stdint.h>
#include <string.h>

static inline double quick_exp(double x)
{
    const double shift = 0x1.8p52, bounded = x < -700.0 ? -700.0 : x > 700.0 ? 700.0 : x;
    const double n = (bounded * 0x1.71547652b82fep0 + shift) - shift;
    const double r = (bounded - n * 0x1.62e42fefa39efp-1) - n * 0x1.abc9e3b39803fp-56;
    const double r2 = r * r, r4 = r2 * r2;
    const double low = (1.0 + r) + r2 * (1.0 / 2.0 + r * (1.0 / 6.0));
    const double middle = (1.0 / 24.0 + r * (1.0 / 120.0)) + r2 * (1.0 / 720.0 + r * (1.0 / 5040.0));
    const double high = (1.0 / 40320.0 + r * (1.0 / 362880.0)) + r2 * (1.0 / 3628800.0 + r * (1.0 / 39916800.0));
    const double last = 1.0 / 479001600.0 + r * (1.0 / 6227020800.0);
    const double fraction = low + r4 * (middle + r4 * (high + r4 * last));
    const uint64_t bits = (uint64_t)((int64_t)n + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return fraction * power;
}

#endif
