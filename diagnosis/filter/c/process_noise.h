/* Process noise over a step: of states that remember, of speeds, of all others. */
#ifndef PROCESS_NOISE_H
#define PROCESS_NOISE_H

#include "estimate.h"

/* What is left over a step of each state that is noise with a memory, exactly: rows may be further apart than it lasts. Others keep all. */
static void forgetting(const filter_state *at, double h_s, double *kept, double *noise)
{
    const filter_request *const r = at->request;
    for (int i = 0; i < N; i++) {
        kept[i] = 1.0;
        if (r->forget[i] > 0.0 && AWAKE(at->states, i)) {
            kept[i] = exp(-r->forget[i] * h_s);
            noise[i] = 0.5 * r->q[i] / r->forget[i] * (1.0 - kept[i] * kept[i]);
        }
    }
}

/* Noise of states other than speeds comes half before a step's motion, half behind it; of one with a memory, of which `kept` is left,
 * (1 - kept^2) q / 2 rate in all. */
static void halve(filter_state *at, const double *kept, double *noise)
{
    for (int i = 0; i < N; i++) {
        noise[i] /= 1.0 + kept[i] * kept[i];
        at->P[i][i] += noise[i];
    }
}

/* White noise on a speed as it spreads within the step, the integral of g(t) g(t)' dt noise / h with g(t) the speed's column of F over t:
 * by Gauss's rule at two instants, which is exact for the speed and its position. As a sum of squares it leaves no reading, however sure
 * and however far behind the speed, a variance below zero. */
static void stir(filter_state *at, int v, double h_s, double noise)
{
    for (int k = 0; k < INSTANTS; k++) {
        const double t_s = INSTANT[k] * h_s;
        double g[WIDTH] __attribute__((aligned(sizeof(block)))) = {0.0};
        for (int n = 0; n < at->states.awake; n++) {
            const int i = at->states.order[n];
            g[i] = (i == v) + t_s * (at->A[i][v] + 0.5 * t_s * at->square[i][v]);
        }
        for (int i = 0; i < N; i++) {
            if (!FOLLOWING(at->states, i))
                continue;
            const follow_weights w = at->following[i].until[k];
            g[i] = 0.0;
            for (int m = 0; m < N; m++)
                if (m != i && A_HAS[i][m])
                    g[i] += at->A[i][m] * (w.last * g[m] + (m == v ? w.first : 0.0));
        }
        for (int n = 0; n < at->states.awake; n++) {
            const int i = at->states.order[n];
            UNROLLED for (int b = 0; b < ROW; b++)
                if (g[i] != 0.0 && FILLED(at->states, b))
                    ((block *)at->P[i])[b] += 0.5 * noise * g[i] * ((const block *)g)[b];
        }
    }
}

#endif
