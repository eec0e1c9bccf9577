/* The mean over a substep, its Jacobians there, and the slopes of the mean by parameters. */
#ifndef MEAN_H
#define MEAN_H

#include "events.h"
#include "lag.h"
#include "rest.h"
#include "substep.h"

/* By Runge and Kutta's step, event by event where friction or a stop may act; noise with a memory by what is kept of it. */
static void move_mean(filter_state *at, const substep *part)
{
    double x[N];
    step_stages seen;
    rk4_step(part->t_s, part->h_s, &at->body, at->u, at->c, x, &seen);
    const bool suspect = N_AXES + N_KINKS > 0 && any(step_suspect(&at->body, x, part->h_s, at->c, &seen));
    if (suspect)
        at->events += events_advance(at->body.x, at->body.sign, at->body.move, part->t_s, part->h_s, at->u, at->c, NULL, NULL) - 1;
    else
        for (int i = 0; i < N; i++)
            at->body.x[i] = x[i];
    for (int i = 0; i < N; i++)
        if (part->kept[i] < 1.0)
            at->body.x[i] = part->kept[i] * part->before.x[i];
}

/* What acts beside the equations; an axis that is held stays. */
static void add_to_mean(filter_state *at, const substep *part)
{
    if (!at->request->added)
        return;
    double added[N];
    for (int i = 0; i < N; i++)
        added[i] = added_to(at, part, i);
    for (int a = 0; a < N_AXES; a++)
        if (part->held[a])
            added[AXIS_VELOCITY[a]] = 0.0;
    for (int i = 0; i < N; i++)
        at->body.x[i] += added[i];
}

static void find_middle(const filter_state *at, const substep *part, double *middle)
{
    for (int i = 0; i < N; i++)
        middle[i] = 0.5 * (part->before.x[i] + at->body.x[i]);
}

/* The Jacobians at the middle. That of the rates comes first: by it states that follow find where they are, which moves the middle. */
static void differentiate(filter_state *at, const substep *part)
{
    const double middle_s = part->t_s + 0.5 * part->h_s;
    double middle[N];
    find_middle(at, part, middle);
    model_state_slopes(middle_s, middle, at->u, at->c, at->body.sign, at->j.A);
    follow(at, part);
    find_middle(at, part, middle);
    if (at->request->columns)
        model_parameter_slopes(middle_s, middle, at->u, at->c, at->body.sign, at->j.D);
}

/* The mean stays where friction holds it, however unsure its speed is: parameters move nothing there. */
static void carry_slopes(filter_state *at, const substep *part)
{
    empty_rows(part->held, at->j.A, N);
    empty_rows(part->held, at->j.D, N_PARAMETERS);
    move_slopes(&at->slopes, at->request, &at->states, part->h_s, at->j.A, at->j.D, part->kept, at->following);
    for (int a = 0; a < N_AXES; a++)
        if (part->held[a])
            hold_slopes(&at->slopes, at->request, AXIS_VELOCITY[a]);
}

#endif
