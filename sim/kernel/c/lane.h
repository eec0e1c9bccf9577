/* Numbers of one run (LANES 1) or of LANES runs side by side, written once for both.
 *
 * Every operation here rounds alike in both forms, and the build forbids contraction and re-ordering, so a run has the same bits
 * whether it is computed alone or in a batch.
 */
#ifndef LANE_H
#define LANE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#if LANES == 1

typedef double num;
typedef int64_t mask; /* 0 or not 0 */

static inline num splat(double value) { return value; }
static inline double lane_get(num a, int lane) { (void)lane; return a; }
static inline void lane_set(num *a, int lane, double value) { (void)lane; *a = value; }
static inline num select(mask m, num a, num b) { return m ? a : b; }
static inline bool any(mask m) { return m != 0; }
static inline bool all(mask m) { return m != 0; }
static inline bool lane_is(mask m, int lane) { (void)lane; return m != 0; }
static inline mask is_less(num a, num b) { return a < b; }
static inline mask is_less_equal(num a, num b) { return a <= b; }
static inline mask is_equal(num a, num b) { return a == b; }
static inline num lane_abs(num a) { return fabs(a); }
static inline num lane_copysign(num a, num b) { return copysign(a, b); }

#else

typedef double num __attribute__((vector_size(8 * LANES)));
typedef int64_t mask __attribute__((vector_size(8 * LANES))); /* 0 or -1 in each lane */

static inline num splat(double value) { return (num){} + value; }
static inline double lane_get(num a, int lane) { return a[lane]; }
static inline void lane_set(num *a, int lane, double value) { (*a)[lane] = value; }
static inline num select(mask m, num a, num b) { return (num)((m & (mask)a) | (~m & (mask)b)); }
static inline bool any(mask m) { return __builtin_reduce_or(m) != 0; }
static inline bool all(mask m) { return __builtin_reduce_and(m) != 0; }
static inline bool lane_is(mask m, int lane) { return m[lane] != 0; }
static inline mask is_less(num a, num b) { return a < b; }
static inline mask is_less_equal(num a, num b) { return a <= b; }
static inline mask is_equal(num a, num b) { return a == b; }
static inline num lane_abs(num a) { return __builtin_elementwise_abs(a); }
static inline num lane_copysign(num a, num b) { return __builtin_elementwise_copysign(a, b); }

#endif

#define NUM(value) splat(value)
#define UNROLLED _Pragma("clang loop unroll(full)")
#define ALWAYS_INLINE static inline __attribute__((always_inline))
#ifndef MODEL_CODE /* how a plant's equations are compiled: inside their callers, or once for all where the compiler's time counts */
#ifdef EQUATIONS_ONCE
#define MODEL_CODE static __attribute__((noinline, unused))
#else
#define MODEL_CODE ALWAYS_INLINE
#endif
#endif

static inline num lane_min(num a, num b) { return select(is_less(b, a), b, a); }
static inline num lane_max(num a, num b) { return select(is_less(a, b), b, a); }
static inline num lane_clamp(num a, num lower, num upper) { return lane_min(lane_max(a, lower), upper); }
static inline int64_t lane_bits(num a) { return (int64_t)lane_get(a, 0); } /* switches, alike in all lanes */
static inline num lane_step(num a) { return select(is_less(NUM(0.0), a), NUM(1.0), NUM(0.0)); }
static inline num lane_sign(num a) { return select(is_equal(a, NUM(0.0)), NUM(0.0), lane_copysign(NUM(1.0), a)); }

/* Nearest integer, ties to even, exact for |a| < 2^51; the additions are not to be folded away, which no flag of the build allows. */
static inline num lane_round(num a)
{
    const num shift = NUM(0x1.8p52);
    return (a + shift) - shift;
}

/* Functions of libm, lane by lane: the same bits as in a single run. */
#define LANEWISE(name)                                                                                                 \
    static inline num lane_##name(num a)                                                                               \
    {                                                                                                                  \
        for (int lane = 0; lane < LANES; lane++)                                                                       \
            lane_set(&a, lane, name(lane_get(a, lane)));                                                               \
        return a;                                                                                                      \
    }
LANEWISE(exp)
LANEWISE(log)
LANEWISE(tan)
LANEWISE(asin)
LANEWISE(acos)
LANEWISE(atan)
LANEWISE(sinh)
LANEWISE(cosh)
LANEWISE(tanh)
LANEWISE(asinh)
LANEWISE(acosh)
LANEWISE(atanh)
LANEWISE(erf)
LANEWISE(erfc)
LANEWISE(floor)
LANEWISE(ceil)
LANEWISE(sqrt)
#undef LANEWISE

static inline num lane_pow(num a, num exponent)
{
    for (int lane = 0; lane < LANES; lane++)
        lane_set(&a, lane, pow(lane_get(a, lane), lane_get(exponent, lane)));
    return a;
}

static inline num lane_atan2(num y, num x)
{
    for (int lane = 0; lane < LANES; lane++)
        lane_set(&y, lane, atan2(lane_get(y, lane), lane_get(x, lane)));
    return y;
}

#endif
