/* States that follow others and that none follows, x' = g - rate x, as what a lagging sensor reads. Over a time t in which g changes evenly
 *
 *     x(t) = kept x(0) + first g(0) + last g(t),   kept = e^-z, first = t (phi1 - phi2), last = t phi2,
 *     z = rate t, phi1 = (1 - e^-z) / z, phi2 = (1 - phi1) / z
 *
 * (Hochbruck and Ostermann, Exponential integrators, Acta Numerica 2010, section 2): right however long t is beside 1 / rate, so that
 * these states need no substeps. */
#ifndef FOLLOW_H
#define FOLLOW_H

#include "states.h"

#define SHORT 0.1      /* z, below which phi1 and phi2 are taken by their series, there right to 1e-8 */
#define AS_LONG 1e-9   /* of z: rows as far apart as the last, but for what rounding leaves of their times */
#define INSTANTS 2     /* within a step, at which noise on a speed is taken */
static const double INSTANT[INSTANTS] = {0.21132486540518712, 0.78867513459481288}; /* 1/2 -+ 1/sqrt(12), Gauss's */

typedef struct {
    double kept, first, last;
} follow_weights;

/* Those of a state over a step, and from its beginning to each instant within; of which z. */
typedef struct {
    double z;
    follow_weights whole, until[INSTANTS];
} follow_state;

static follow_weights follow_weights_of(double rate, double t)
{
    const double z = rate * t;
    double phi1 = 1.0 - z / 2.0 * (1.0 - z / 3.0 * (1.0 - z / 4.0 * (1.0 - z / 5.0)));
    double phi2 = 0.5 * (1.0 - z / 3.0 * (1.0 - z / 4.0 * (1.0 - z / 5.0 * (1.0 - z / 6.0))));
    if (z > SHORT) {
        phi1 = (1.0 - exp(-z)) / z;
        phi2 = (1.0 - phi1) / z;
    }
    return (follow_weights){1.0 - z * phi1, t * (phi1 - phi2), t * phi2};
}

/* The weights of each awake state that follows, over a step of h; they stay as they are while z does. */
static void follow_over(follow_state *following, const awake_states *states, const double *A, double h_s)
{
    for (int i = 0; i < N; i++) {
        const double rate = -A[i * N + i], z = rate * h_s;
        if (!FOLLOWING(*states, i) || fabs(z - following[i].z) < AS_LONG * z)
            continue;
        following[i].z = z;
        following[i].whole = follow_weights_of(rate, h_s);
        for (int k = 0; k < INSTANTS; k++)
            following[i].until[k] = follow_weights_of(rate, INSTANT[k] * h_s);
    }
}

#endif
