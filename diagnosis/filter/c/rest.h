/* Friction about rest: how much of it is in doubt, which axes it holds, and what is unknown of those. */
#ifndef REST_H
#define REST_H

#include "estimate.h"
#include "quick_exp.h"

#define UNSURE 10.0 /* times what friction stops in a step, beyond which a speed's spread is no rest */

/* What the friction of each axis may do: its level as an acceleration at rest, in doubt for `rub` seconds about v = 0. */
static void doubt(const filter_state *at, const double *level, double h_s, double *noise)
{
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        const double rub = at->request->rub[a], square = level[a] * level[a];
        const double rest_s = at->request->rest_s, width = square * rest_s * rest_s + at->P[v][v];
        if (square > 0.0 && rub > 0.0)
            noise[v] += square * h_s * rub * quick_exp(-0.5 * at->body.x[v] * at->body.x[v] / (width + 1e-12));
    }
}

/* Which axes are taken to rest: held by a stop, or by friction that could have stopped what is known of their speed. Where a flight
 * begins nothing is, and an axis that the first guess holds may well be moving: to take it as sure would keep all later readings out. */
static void resting(const filter_state *at, const double *level, double h_s, const double *noise, bool *rests)
{
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        const double position = at->body.x[AXIS_POSITION[a]], stopped = level[a] * at->request->rest_s;
        const bool rubs = level[a] > 0.0 && !at->request->locked[a] && position > at->c[AXIS_LOWER[a]] && position < at->c[AXIS_UPPER[a]];
        const double usual = noise[v] * at->request->rest_s / h_s;
        const bool unsure = rubs && at->P[v][v] > UNSURE * UNSURE * (usual + stopped * stopped);
        rests[a] = at->body.move[a] == 0.0 && !unsure;
    }
}

/* The rows of the axes' speeds, of `width` numbers each, set to 0 where chosen. */
static void empty_rows(const bool *chosen, double *rows, int width)
{
    for (int a = 0; a < N_AXES; a++)
        for (int k = 0; chosen[a] && k < width; k++)
            rows[AXIS_VELOCITY[a] * width + k] = 0.0;
}

/* The column of F by which a speed moves all other states, times a factor. */
static void scale_column(filter_state *at, int v, double factor)
{
    for (int n = 0; n < at->states.awake; n++)
        if (at->states.order[n] != v)
            at->F[at->states.order[n]][v] *= factor;
}

#endif
