/* A step from an instant to the next goes in substeps, short enough for series that end at h^2. */
#ifndef SUBSTEP_H
#define SUBSTEP_H

#include "estimate.h"

#define FASTEST 0.5        /* of a state's own time constant, or of a radian's time of a swing, that a substep may last, */
#define MANY_SUBSTEPS 8.0  /* but for so many: beyond, nothing is left of it anyway, and a substep need only be so short */
#define FADES 1.5          /* that the series, too, make less of it: at 2 they would begin to grow */
#define MOST_SUBSTEPS 16.0 /* or so many times what the plant needs as its file states it: faster become parameters and states that */
#define AS_STATED 4.0      /* make no sense, and a lag so much shorter than a row is none: antx_2dof_drone, 40 us of 4 ms */

/* `share` of a step from t_s on, and what its parts hand to one another. */
typedef struct {
    int64_t step;
    double t_s, h_s, share;
    plant_body before;            /* the mean where it begins */
    double noise[N];              /* variance that it brings each state */
    double kept[N];               /* what is left over it of each state that is noise with a memory; 1 of others */
    double friction[AXES];        /* of each axis, as an acceleration at rest */
    bool held[AXES], rests[AXES]; /* axes whose mean stays; those of them that are sure to */
} substep;

/* What acts beside the equations adds to a state over it. */
static double added_to(const filter_state *at, const substep *part, int i)
{
    return at->request->added ? at->request->added[part->step * N + i] * part->share : 0.0;
}

/* The rate of the fastest state, and of the fastest two that swing against each other; but for noise with a memory and states that follow,
 * which move exactly. */
static double fastest_rad_s(const filter_state *at)
{
    const double *const A = at->j.A;
    double fastest = 0.0, swinging = 0.0;
    UNROLLED for (int i = 0; i < N; i++) {
        if (!AWAKE(at->states, i) || FOLLOWING(at->states, i) || at->request->forget[i] > 0.0)
            continue;
        fastest = fmax(fastest, fabs(A[i * N + i]));
        UNROLLED for (int k = 0; k < i; k++)
            if (A_HAS[i][k] && A_HAS[k][i])
                swinging = fmax(swinging, fabs(A[i * N + k] * A[k * N + i]));
    }
    return fmax(fastest, sqrt(swinging));
}

/* How many a step has: as many as its fastest motion needs. */
static int substeps_of(const filter_state *at, double h_s)
{
    const double span = h_s * fastest_rad_s(at), enough = fmax(MANY_SUBSTEPS, ceil(span / FADES));
    const double most = fmax(MOST_SUBSTEPS, ceil(AS_STATED * h_s * at->request->stated_rad_s / FADES));
    return (int)fmin(fmax(ceil(span / FASTEST), 1.0), fmin(enough, most));
}

#endif
