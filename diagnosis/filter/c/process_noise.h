/* Process noise over a substep: white noise in the rates of states, of which some remember; half of it before the motion, half behind it,
 * but on speeds as it spreads. */
#ifndef PROCESS_NOISE_H
#define PROCESS_NOISE_H

#include "noise_slopes.h"
#include "substep.h"

/* What the substep brings each state that is awake, further variance that somebody knows of included. */
static void find_noise(const filter_state *at, substep *part)
{
    const filter_request *const r = at->request;
    for (int i = 0; i < N; i++)
        part->noise[i] =
            AWAKE(at->states, i) ? r->q[i] * part->h_s + (r->further ? r->further[part->step * N + i] * part->share : 0.0) : 0.0;
}

/* What is left over the substep of each state that is noise with a memory, exactly: rows may be further apart than it lasts. Others keep
 * all. */
static void find_memory(const filter_state *at, substep *part)
{
    const filter_request *const r = at->request;
    for (int i = 0; i < N; i++) {
        part->kept[i] = 1.0;
        if (r->forget[i] > 0.0 && AWAKE(at->states, i)) {
            part->kept[i] = exp(-r->forget[i] * part->h_s);
            part->noise[i] = 0.5 * r->q[i] / r->forget[i] * (1.0 - part->kept[i] * part->kept[i]);
        }
    }
}

/* The half before the motion, and as much left for behind it; of noise with a memory, of which `kept` is left, (1 - kept^2) q / 2 rate in
 * all. */
static void add_half(filter_state *at, substep *part)
{
    for (int i = 0; i < N; i++) {
        part->noise[i] /= 1.0 + part->kept[i] * part->kept[i];
        at->P[i][i] += part->noise[i];
    }
}

/* The column of F by which a speed moves all states, over the k-th instant's share of the substep. */
static void speed_column(const filter_state *at, int v, double h_s, int k, double *g)
{
    const double t_s = INSTANT[k] * h_s;
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
}

/* White noise on a speed as it spreads within the substep, the integral of g(t) g(t)' dt noise / h with g(t) the speed's column of F over
 * t: by Gauss's rule at two instants, which is exact for the speed and its position. As a sum of squares it leaves no reading, however
 * sure and however far behind the speed, a variance below zero. */
static void spread_noise(filter_state *at, int axis, double h_s, double noise)
{
    const int v = AXIS_VELOCITY[axis];
    double g[INSTANTS][WIDTH] __attribute__((aligned(sizeof(piece)))) = {{0.0}};
    for (int k = 0; k < INSTANTS; k++)
        speed_column(at, v, h_s, k, g[k]);
    for (int n = 0; n < at->states.awake; n++) {
        const int i = at->states.order[n];
        if (g[0][i] == 0.0 && g[1][i] == 0.0)
            continue;
        const double first = 0.5 * noise * g[0][i], last = 0.5 * noise * g[1][i];
        UNROLLED for (int b = 0; b < ROW; b++)
            if (FILLED(at->states, b))
                ((piece *)at->P[i])[b] += first * ((const piece *)g[0])[b] + last * ((const piece *)g[1])[b];
    }
    spread_noise_slopes(at, axis, g);
}

#endif
