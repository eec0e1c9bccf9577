/*
 * soft_float.c - sum and product of floats in integers, for a core without FPU.
 *
 * IEEE 754 binary32, to nearest even, subnormals included: bit for bit what the host computes; every NaN result is the quiet
 * 0x7FC00000. No path is much longer than another, as the law's time is bounded by the longest.
 */
#include "soft_float.h"

#define SIGN 0x80000000u
#define INFINITY_BITS 0x7F800000u
#define QUIET_NAN 0x7FC00000u
#define FRACTION 0x007FFFFFu
#define HIDDEN_ONE 0x00800000u
#define EXPONENT_BIAS 127
#define LARGEST_EXPONENT 254

#define GUARD_BITS 7u /* below the 24 bits of a significand in a sum, the lowest one sticky */

/* Exponent field of a finite magnitude; subnormals have that of the least normal numbers. */
static uint32_t exponent_of(uint32_t magnitude)
{
    const uint32_t field = magnitude >> 23;
    return (field == 0u) ? 1u : field;
}

static uint32_t significand_of(uint32_t magnitude)
{
    const uint32_t fraction = magnitude & FRACTION;
    return ((magnitude >> 23) == 0u) ? fraction : (fraction | HIDDEN_ONE);
}

/* value >> distance with every lost one kept in the lowest bit */
static uint32_t shifted_right(uint32_t value, uint32_t distance)
{
    if (distance > 31u) {
        return (value != 0u) ? 1u : 0u;
    }
    const uint32_t shifted = value >> distance;
    return ((shifted << distance) != value) ? (shifted | 1u) : shifted;
}

/* Moves the leading one of a number that is not zero up to bit 30; returns the shift that took. */
static uint32_t lifted(uint32_t *value)
{
    uint32_t shift = 0u;
    for (uint32_t step = 16u; step != 0u; step >>= 1) {
        if ((*value >> (31u - step)) == 0u) {
            *value <<= step;
            shift += step;
        }
    }
    return shift;
}

/* A significand with GUARD_BITS below, its leading one at bit 30 unless the exponent is 1, rounded and put together. */
static uint32_t packed_sum(uint32_t sign, uint32_t exponent, uint32_t significand)
{
    if (exponent > LARGEST_EXPONENT) {
        return sign | INFINITY_BITS;
    }
    const uint32_t odd = (significand >> GUARD_BITS) & 1u;
    const uint32_t rounded = (significand + 0x3Fu + odd) >> GUARD_BITS;
    return sign + ((exponent - 1u) << 23) + rounded; /* the hidden one, and a carry, step the exponent */
}

/* larger - smaller of magnitudes; only a difference that is exact can lose more than one place. */
static uint32_t packed_difference(uint32_t sign, uint32_t exponent, uint32_t significand)
{
    if (significand == 0u) {
        return 0u;
    }
    uint32_t moved = significand;
    const uint32_t shift = lifted(&moved);
    if (shift < exponent) {
        return packed_sum(sign, exponent - shift, moved);
    }
    return packed_sum(sign, 1u, significand << (exponent - 1u)); /* subnormal */
}

uint32_t soft_float_sum(uint32_t a, uint32_t b)
{
    uint32_t larger = a & ~SIGN;
    uint32_t smaller = b & ~SIGN;
    uint32_t sign = a & SIGN;
    if (larger < smaller) {
        larger = b & ~SIGN;
        smaller = a & ~SIGN;
        sign = b & SIGN;
    }
    const uint32_t opposite = (a ^ b) & SIGN;
    if (larger >= INFINITY_BITS) {
        const uint32_t cancelled = (opposite != 0u && larger == smaller) ? 1u : 0u;
        return (larger > INFINITY_BITS || cancelled != 0u) ? QUIET_NAN : (sign | INFINITY_BITS);
    }
    if (smaller == 0u) {
        return (larger == 0u) ? (a & b) : (sign | larger);
    }
    const uint32_t exponent = exponent_of(larger);
    const uint32_t distance = exponent - exponent_of(smaller);
    const uint32_t one = significand_of(larger) << GUARD_BITS;
    const uint32_t other = shifted_right(significand_of(smaller) << GUARD_BITS, distance);
    if (opposite != 0u) {
        return packed_difference(sign, exponent, one - other);
    }
    const uint32_t sum = one + other;
    if ((sum >> 31) != 0u) {
        return packed_sum(sign, exponent + 1u, (sum >> 1) | (sum & 1u));
    }
    return packed_sum(sign, exponent, sum);
}

/* 2^16 upper + lower is the product of two significands, upper with its leading one at bit 31. */
static uint32_t packed_product(uint32_t sign, int32_t exponent, uint32_t upper, uint32_t lower)
{
    if (exponent > LARGEST_EXPONENT) {
        return sign | INFINITY_BITS;
    }
    uint32_t significand = (lower != 0u) ? (upper | 1u) : upper;
    uint32_t stored = (uint32_t)exponent - 1u;
    if (exponent < 1) {
        significand = shifted_right(significand, (uint32_t)(1 - exponent));
        stored = 0u;
    }
    const uint32_t rest = significand & 0xFFu;
    uint32_t bits = sign + (stored << 23) + (significand >> 8);
    if (rest + (bits & 1u) > 0x80u) {
        bits++; /* a carry steps the exponent, up to infinity */
    }
    return bits;
}

/* Product of finite magnitudes that are not zero, the larger one normal. */
static uint32_t finite_product(uint32_t sign, uint32_t larger, uint32_t smaller)
{
    int32_t exponent = (int32_t)(exponent_of(larger) + exponent_of(smaller)) + 1 - EXPONENT_BIAS;
    const uint32_t one = significand_of(larger);
    uint32_t other = significand_of(smaller);
    if ((other & HIDDEN_ONE) == 0u) {
        exponent -= (int32_t)lifted(&other) - (int32_t)GUARD_BITS;
        other >>= GUARD_BITS;
    }
    const uint32_t lows = (one & 0xFFFFu) * (other & 0xFFFFu);
    const uint32_t middle = (one & 0xFFFFu) * (other >> 16) + (one >> 16) * (other & 0xFFFFu);
    uint32_t upper = (((one >> 16) * (other >> 16)) << 16) + middle + (lows >> 16);
    if ((upper >> 31) == 0u) {
        upper <<= 1; /* what comes up from below stays below the half and counts as lost */
        exponent--;
    }
    return packed_product(sign, exponent, upper, lows & 0xFFFFu);
}

uint32_t soft_float_product(uint32_t a, uint32_t b)
{
    const uint32_t sign = (a ^ b) & SIGN;
    uint32_t larger = a & ~SIGN;
    uint32_t smaller = b & ~SIGN;
    if (larger < smaller) {
        larger = b & ~SIGN;
        smaller = a & ~SIGN;
    }
    if (larger >= INFINITY_BITS) {
        return (larger > INFINITY_BITS || smaller == 0u) ? QUIET_NAN : (sign | INFINITY_BITS);
    }
    if (smaller == 0u || larger < HIDDEN_ONE) {
        return sign; /* of two subnormals nothing is left */
    }
    return finite_product(sign, larger, smaller);
}
