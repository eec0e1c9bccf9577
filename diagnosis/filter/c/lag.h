/* States that follow others (follow.h) over a substep: their mean, and their rows of the transition. */
#ifndef LAG_H
#define LAG_H

#include "substep.h"

/* Where they are at its end, by the Jacobian A at its middle. */
static void follow(filter_state *at, const substep *part)
{
    bool any_follows = false;
    for (int i = 0; i < N; i++)
        any_follows |= FOLLOWING(at->states, i);
    if (!any_follows)
        return;
    const double *const x = part->before.x, *const A = at->j.A;
    double rates[N], torque[AXES], up[AXES], down[AXES];
    follow_over(at->following, &at->states, A, part->h_s);
    model_rates(part->t_s, x, at->u, at->c, part->before.sign, part->before.move, rates, torque, up, down);
    for (int i = 0; i < N; i++) {
        if (!FOLLOWING(at->states, i))
            continue;
        const follow_weights w = at->following[i].whole;
        double g = rates[i] - A[i * N + i] * x[i], changed = 0.0;
        for (int m = 0; m < N; m++)
            if (m != i && A_HAS[i][m])
                changed += A[i * N + m] * (at->body.x[m] - x[m]);
        at->body.x[i] = w.kept * x[i] + (w.first + w.last) * g + w.last * changed + added_to(at, part, i);
    }
}

/* The rows of F of states that follow, once those of all others are there. */
static void follow_transition(filter_state *at)
{
    UNROLLED for (int i = 0; i < N; i++) {
        if (!FOLLOWING(at->states, i))
            continue;
        const follow_weights w = at->following[i].whole;
        UNROLLED for (int k = 0; k < N; k++) {
            double sum = 0.0;
            UNROLLED for (int m = 0; m < N; m++)
                if (m != i && A_HAS[i][m])
                    sum += at->A[i][m] * (w.last * at->F[m][k] + (m == k ? w.first : 0.0));
            if (F_HAS[i][k])
                at->F[i][k] = i == k ? w.kept : sum;
        }
    }
}

#endif
