/* In how many pieces a step is done. */
#ifndef SUBSTEPS_H
#define SUBSTEPS_H

#include "estimate.h"

#define FASTEST 0.5     /* of a state's own time constant, or of a radian's time of a swing, that a piece of a step may last, */
#define MANY_PIECES 8.0 /* but for so many: beyond, nothing is left of it anyway, and a piece need only be so short */
#define FADES 1.5       /* that the series, too, make less of it: at 2 they would begin to grow */
#define MOST_PIECES 64.0

/* How many pieces a step is done in: as many as the fastest state, and the fastest two that swing against each other, need for series that
 * end at h^2; but for noise with a memory and states that follow. */
static int pieces_of(const filter_state *at, double h_s)
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
    const double span = h_s * fmax(fastest, sqrt(swinging)), enough = fmax(MANY_PIECES, ceil(span / FADES));
    return (int)fmin(fmax(ceil(span / FASTEST), 1.0), fmin(enough, MOST_PIECES));
}

#endif
