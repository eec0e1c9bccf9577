/*
 * soft_float.c - sum and product of floats in integers, for a core without FPU.
 *
 * IEEE 754 binary32, to nearest even, subnormals included: bit for bit what the host computes; every NaN result is the quiet
 * 0x7FC00000.
 */
#include "soft_float.h"

#include <stdbool.h>

#define SIGN 0x80000000u
#define INFINITY_BITS 0x7F800000u
#define QUIET_NAN 0x7FC00000u
#define FRACTION 0x007FFFFFu
#define HIDDEN_ONE 0x00800000u
#define EXPONENT_BIAS 127
#define LARGEST_EXPONENT 254

#define GUARD_BITS 7u /* below the 24 bits of a significand in a sum, the lowest one sticky */

static uint32_t exponent_of(uint32_t bits)
{
    return (bits >> 23) & 0xFFu;
}

static uint32_t significand_of(uint32_t bits)
{
    return (bits & FRACTION) | HIDDEN_ONE;
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

/* A significand with GUARD_BITS below and its leading one at bit 30, rounded and put together with exponent 1..254 or below. */
static uint32_t packed_sum(uint32_t sign, int32_t exponent, uint32_t significand)
{
    if (exponent > LARGEST_EXPONENT) {
        return sign | INFINITY_BITS;
    }
    if (exponent < 1) { /* only after cancellation or of subnormals: the shift loses nothing */
        significand >>= (uint32_t)(1 - exponent);
        return sign | (significand >> GUARD_BITS);
    }
    const uint32_t odd = (significand >> GUARD_BITS) & 1u;
    const uint32_t rounded = (significand + 0x3Fu + odd) >> GUARD_BITS;
    return sign + (((uint32_t)exponent - 1u) << 23) + rounded; /* the hidden one, and a carry, step the exponent */
}

/* The leading one of a difference brought back to bit 30. */
static uint32_t normalised(uint32_t sign, int32_t exponent, uint32_t significand)
{
    if (significand == 0u) {
        return 0u;
    }
    for (uint32_t step = 16u; step != 0u; step >>= 1) {
        if ((significand >> (31u - step)) == 0u) {
            significand <<= step;
            exponent -= (int32_t)step;
        }
    }
    return packed_sum(sign, exponent, significand);
}

/* Sum where an operand is zero, subnormal, infinite or NaN; |larger| >= |smaller|. */
static uint32_t special_sum(uint32_t larger, uint32_t smaller)
{
    if (exponent_of(larger) == 0xFFu) {
        const bool opposite_infinities = (larger ^ smaller) == SIGN;
        const bool is_nan = (larger & FRACTION) != 0u;
        return (is_nan || opposite_infinities) ? QUIET_NAN : larger;
    }
    if ((smaller & ~SIGN) == 0u) {
        return ((larger & ~SIGN) == 0u) ? (larger & smaller) : larger;
    }
    const uint32_t exponent = exponent_of(larger);
    const uint32_t one = (exponent == 0u) ? (larger & FRACTION) : significand_of(larger);
    const uint32_t distance = (exponent == 0u) ? 0u : exponent - 1u;
    const uint32_t other = shifted_right((smaller & FRACTION) << GUARD_BITS, distance);
    const bool subtract = ((larger ^ smaller) & SIGN) != 0u;
    const uint32_t wide = one << GUARD_BITS;
    const uint32_t sum = subtract ? wide - other : wide + other;
    const int32_t scale = (exponent == 0u) ? 1 : (int32_t)exponent;
    if ((sum >> 31) != 0u) {
        return packed_sum(larger & SIGN, scale + 1, shifted_right(sum, 1u));
    }
    return normalised(larger & SIGN, scale, sum);
}

uint32_t soft_float_sum(uint32_t a, uint32_t b)
{
    uint32_t larger = a;
    uint32_t smaller = b;
    if ((a << 1) < (b << 1)) {
        larger = b;
        smaller = a;
    }
    const uint32_t exponent = exponent_of(larger);
    const uint32_t lower = exponent_of(smaller);
    if (exponent == 0xFFu || lower == 0u) {
        return special_sum(larger, smaller);
    }
    const uint32_t distance = exponent - lower;
    const uint32_t wide = significand_of(smaller) << GUARD_BITS;
    uint32_t other = 1u; /* far below: only sticky */
    if (distance < 31u) {
        other = wide >> distance;
        if ((other << distance) != wide) {
            other |= 1u;
        }
    }
    const uint32_t significand = significand_of(larger) << GUARD_BITS;
    if (((larger ^ smaller) & SIGN) != 0u) {
        const uint32_t difference = significand - other;
        if ((difference >> 30) == 0u) {
            return normalised(larger & SIGN, (int32_t)exponent, difference);
        }
        return packed_sum(larger & SIGN, (int32_t)exponent, difference);
    }
    const uint32_t sum = significand + other;
    if ((sum >> 31) != 0u) {
        return packed_sum(larger & SIGN, (int32_t)exponent + 1, (sum >> 1) | (sum & 1u));
    }
    return packed_sum(larger & SIGN, (int32_t)exponent, sum);
}

/* A product beyond the largest number, or below the least normal one. */
static uint32_t extreme_product(uint32_t sign, int32_t exponent, uint32_t high, uint32_t low)
{
    if (exponent > LARGEST_EXPONENT) {
        return sign | INFINITY_BITS;
    }
    const uint32_t whole = (high << 8) | (low >> 24) | (((low << 8) != 0u) ? 1u : 0u);
    const uint32_t shifted = shifted_right(whole, (uint32_t)(1 - exponent));
    return sign | ((shifted + 0x7Fu + ((shifted >> 8) & 1u)) >> 8);
}

/* high 2^24 + low is the product of two 24-bit significands: 2^46 <= product < 2^48. */
static inline uint32_t packed_product(uint32_t sign, int32_t exponent, uint32_t one, uint32_t other)
{
    const uint32_t one_high = one >> 12, one_low = one & 0xFFFu;
    const uint32_t other_high = other >> 12, other_low = other & 0xFFFu;
    const uint32_t middle = one_high * other_low + one_low * other_high;
    uint32_t low = one_low * other_low + ((middle & 0xFFFu) << 12);
    uint32_t high = one_high * other_high + (middle >> 12) + (low >> 24);
    low <<= 8;
    if ((high & HIDDEN_ONE) == 0u) {
        high = (high << 1) | (low >> 31);
        low <<= 1;
        exponent--;
    }
    if ((uint32_t)(exponent - 1) >= LARGEST_EXPONENT) {
        return extreme_product(sign, exponent, high, low);
    }
    uint32_t bits = sign + (((uint32_t)exponent - 1u) << 23) + high;
    if ((low >> 31) != 0u && ((low << 1) != 0u || (high & 1u) != 0u)) {
        bits++; /* the carry steps the exponent, up to infinity */
    }
    return bits;
}

/* A subnormal as significand with its leading one at bit 23; returns the shift that took. */
static int32_t lifted(uint32_t *significand)
{
    int32_t shift = 0;
    for (uint32_t step = 16u; step != 0u; step >>= 1) {
        if ((*significand >> (24u - step)) == 0u) {
            *significand <<= step;
            shift += (int32_t)step;
        }
    }
    return shift;
}

/* Product where an operand is zero, subnormal, infinite or NaN. */
static uint32_t special_product(uint32_t a, uint32_t b)
{
    const uint32_t sign = (a ^ b) & SIGN;
    const uint32_t one = a & ~SIGN;
    const uint32_t other = b & ~SIGN;
    if (one > INFINITY_BITS || other > INFINITY_BITS) {
        return QUIET_NAN;
    }
    if (one == INFINITY_BITS || other == INFINITY_BITS) {
        return (one == 0u || other == 0u) ? QUIET_NAN : (sign | INFINITY_BITS);
    }
    if (one == 0u || other == 0u) {
        return sign;
    }
    uint32_t significands[2] = {one & FRACTION, other & FRACTION};
    int32_t exponent = 1 - EXPONENT_BIAS;
    for (uint32_t index = 0u; index < 2u; index++) {
        const uint32_t stored = (index == 0u) ? one >> 23 : other >> 23;
        if (stored != 0u) {
            significands[index] |= HIDDEN_ONE;
            exponent += (int32_t)stored;
        } else {
            exponent += 1 - lifted(&significands[index]);
        }
    }
    return packed_product(sign, exponent, significands[0], significands[1]);
}

uint32_t soft_float_product(uint32_t a, uint32_t b)
{
    const uint32_t one = exponent_of(a);
    const uint32_t other = exponent_of(b);
    if (one - 1u >= LARGEST_EXPONENT || other - 1u >= LARGEST_EXPONENT) {
        return special_product(a, b);
    }
    const int32_t exponent = (int32_t)(one + other) + 1 - EXPONENT_BIAS;
    return packed_product((a ^ b) & SIGN, exponent, significand_of(a), significand_of(b));
}

