/* Standard normal numbers that depend on (seed, run, sample, channel) alone, so that any run can be repeated by itself. */
#ifndef NOISE_H
#define NOISE_H

#include <math.h>
#include <stdint.h>

/* SplitMix64, Steele, Lea and Flood 2014: a bijective mixer. */
static inline uint64_t noise_mix(uint64_t z)
{
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Box and Muller's transform of two uniform numbers. */
static inline double noise_normal(uint64_t seed, uint64_t run, uint64_t sample, uint64_t channel)
{
    const uint64_t a = noise_mix(noise_mix(noise_mix(noise_mix(seed) ^ run) ^ sample) ^ channel), b = noise_mix(a);
    const double radius = ((double)(a >> 11) + 0.5) * 0x1p-53, angle = ((double)(b >> 11) + 0.5) * 0x1p-53;
    return sqrt(-2.0 * log(radius)) * cos(6.283185307179586 * angle);
}

#endif
