/* The covariance over a substep, F P F' and process noise: the transition F is the Jacobian's series, to the square of the step. */
#ifndef COVARIANCE_H
#define COVARIANCE_H

#include <string.h>

#include "lag.h"
#include "rest.h"
#include "substep.h"

/* to = left times right, where `has` says which entries of `left` can be other than 0: known to the compiler, which leaves out the rest.
 * Rows of states that sleep are not touched. */
ALWAYS_INLINE void product(const filter_state *at, const matrix left, const int has[N][N], const matrix right, matrix to)
{
    UNROLLED for (int i = 0; i < N; i++) {
        if (!AWAKE(at->states, i))
            continue;
        UNROLLED for (int b = 0; b < ROW; b++) {
            if (!FILLED(at->states, b))
                continue;
            piece sum = {0.0};
            UNROLLED for (int m = 0; m < N; m++)
                if (has[i][m])
                    sum += left[i][m] * ((const piece *)right[m])[b];
            ((piece *)to[i])[b] = sum;
        }
    }
}

/* F = 1 + h A + h^2 A^2 / 2 */
static void series(filter_state *at, double h_s)
{
    UNROLLED for (int i = 0; i < N; i++)
        UNROLLED for (int k = 0; k < N; k++)
            if (A_HAS[i][k])
                at->A[i][k] = at->j.A[i * N + k];
    product(at, at->A, A_HAS, at->A, at->square);
    UNROLLED for (int i = 0; i < N; i++) {
        if (!AWAKE(at->states, i))
            continue;
        UNROLLED for (int k = 0; k < N; k++)
            if (F_HAS[i][k])
                at->F[i][k] = (i == k) + h_s * (at->A[i][k] + 0.5 * h_s * at->square[i][k]);
    }
}

/* F, with the rows that are no series: of speeds at rest, of noise with a memory, of states that follow. */
static void find_transition(filter_state *at, const substep *part)
{
    empty_rows(part->rests, at->j.A, N);
    series(at, part->h_s);
    empty_rows(part->rests, at->F[0], WIDTH);
    for (int i = 0; i < N; i++)
        if (part->kept[i] < 1.0)
            at->F[i][i] = part->kept[i];
    follow_transition(at);
}

/* P = F P F' + noise */
static void propagate(filter_state *at, const double *noise)
{
    product(at, at->F, F_HAS, at->P, at->FP);
    for (int n = 0; n < at->states.awake; n++)
        for (int m = 0; m < at->states.awake; m++)
            at->PF[at->states.order[n]][at->states.order[m]] = at->FP[at->states.order[m]][at->states.order[n]];
    product(at, at->F, F_HAS, at->PF, at->P);
    for (int i = 0; i < N; i++) {
        for (int k = 0; AWAKE(at->states, i) && k < i; k++)
            at->P[k][i] = at->P[i][k];
        at->P[i][i] += noise[i];
    }
}

/* Speeds take their own way of noise, about and behind that of all other states. */
static void predict_covariance(filter_state *at, substep *part)
{
    double brought[AXES] = {0.0};
    part_speeds(at, part, brought);
    part_speed_slopes(at, part);
    add_half(at, part);
    propagate(at, part->noise);
    propagate_noise_slopes(at, part);
    return_speeds(at, part, brought);
}

/* F of the substeps done so far: that of the last times that of those before it. */
static void keep_transition(const filter_state *at, double *F, bool is_first)
{
    double product[N * N];
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            product[i * N + k] = is_first ? at->F[i][k] : 0.0;
            for (int m = 0; !is_first && m < N; m++)
                product[i * N + k] += at->F[i][m] * F[m * N + k];
        }
    memcpy(F, product, sizeof(product));
}

#endif
