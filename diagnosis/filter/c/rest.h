/* Friction about rest: how much of it is in doubt, which axes it holds, and what is unknown of those. */
#ifndef REST_H
#define REST_H

#include "noise_slopes.h"
#include "process_noise.h"
#include "quick_exp.h"
#include "substep.h"

#define UNSURE 10.0  /* times what friction stops in a step, beyond which a speed's spread is no rest */
#define UNFELT 100.0 /* so many powers of e below: a doubt that is none, of numbers that a processor takes long over, as too small */

/* The friction of each axis, and its doubt as noise on the speed: about v = 0 its level is in doubt for `rub` seconds. */
static void doubt_friction(filter_state *at, substep *part)
{
    double sign[AXES];
    for (int a = 0; a < AXES; a++) {
        sign[a] = 1.0;
        part->friction[a] = 0.0;
    }
    model_friction(part->t_s, at->body.x, at->u, at->c, sign, part->friction);
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        const double rub = at->request->rub[a], square = part->friction[a] * part->friction[a];
        const double rest_s = at->request->rest_s, width = square * rest_s * rest_s + at->P[v][v];
        if (!(square > 0.0 && rub > 0.0))
            continue;
        const double away = 0.5 * at->body.x[v] * at->body.x[v] / (width + 1e-12);
        if (away > UNFELT)
            continue;
        const double a_second = square * part->h_s * quick_exp(-away);
        part->noise[v] += rub * a_second;
        doubt_slopes(at, a, a_second, width + 1e-12);
    }
}

/* Which axes are taken to rest: held by a stop, or by friction that could have stopped what is known of their speed. Where a flight
 * begins nothing is, and an axis that the first guess holds may well be moving: to take it as sure would keep all later readings out. */
static void find_rest(const filter_state *at, substep *part)
{
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        const double level = part->friction[a], position = at->body.x[AXIS_POSITION[a]], stopped = level * at->request->rest_s;
        const bool rubs = level > 0.0 && !at->request->locked[a] && position > at->c[AXIS_LOWER[a]] && position < at->c[AXIS_UPPER[a]];
        const double usual = part->noise[v] * at->request->rest_s / part->h_s;
        const bool unsure = rubs && at->P[v][v] > UNSURE * UNSURE * (usual + stopped * stopped);
        part->held[a] = at->body.move[a] == 0.0;
        part->rests[a] = part->held[a] && !unsure;
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

/* Friction stops within the usual step whatever moves an axis at rest: the row of its speed is emptied, and all that is unknown of that
 * comes after. That is what the usual step brings, however long this one is, and moves the other states by the root of time, as steps that
 * know nothing of one another do: so instants more or less change nothing.
 *
 * Takes the noise of speeds from that of the other states to `brought`, until these have moved. */
static void part_speeds(filter_state *at, substep *part, double *brought)
{
    const double usual = at->request->rest_s / part->h_s;
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        brought[a] = at->request->locked[a] ? 0.0 : part->noise[v];
        part->noise[v] = 0.0;
        if (!part->rests[a])
            continue;
        brought[a] *= usual;
        scale_column(at, v, sqrt(usual));
    }
}

/* Gives back what `part_speeds` took. */
static void return_speeds(filter_state *at, const substep *part, const double *brought)
{
    const double usual = at->request->rest_s / part->h_s;
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        if (part->rests[a]) {
            at->P[v][v] += brought[a];
            bring_speed_slopes(at, a);
            scale_column(at, v, 1.0 / sqrt(usual));
        } else if (brought[a] > 0.0)
            spread_noise(at, a, part->h_s, brought[a]);
    }
}

#endif
