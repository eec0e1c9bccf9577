/* How far an event is, and the instant within a step at which it happens; for events.c. */
#ifndef MARGIN_H
#define MARGIN_H

#include <float.h>

#include "events.h"
#include "step.h"

/* A run at one instant, its inputs held. */
typedef struct {
    plant_body body;
    double t_s;
    const double *u, *c;
} moment;

static __attribute__((noinline)) void torques(const moment *at, const double *x, double t_s, double *torque, double *up, double *down)
{
    double dx[N_STATES];
    model_rates(t_s, x, at->u, at->c, at->body.sign, at->body.move, dx, torque, up, down);
}

static bool is_break(int event)
{
    return event == EVENT_BREAK_UP || event == EVENT_BREAK_DOWN;
}

static bool is_kink(int event)
{
    return event == EVENT_KINK_UP || event == EVENT_KINK_DOWN;
}

/* Whether `event` can end the present motion of `axis`. */
static bool watched(const moment *at, int axis, int event)
{
    if (is_kink(event))
        return event == EVENT_KINK_UP ? at->body.x[KINK_STATE[axis]] < 0.0 : at->body.x[KINK_STATE[axis]] > 0.0;
    const double position = at->body.x[AXIS_POSITION[axis]];
    switch (event) {
    case EVENT_REST:
        return at->body.move[axis] != 0.0 && at->body.sign[axis] != 0.0;
    case EVENT_LOWER:
    case EVENT_UPPER:
        return at->body.move[axis] != 0.0;
    case EVENT_BREAK_UP:
        return at->body.move[axis] == 0.0 && position < at->c[AXIS_UPPER[axis]];
    default:
        return at->body.move[axis] == 0.0 && position > at->c[AXIS_LOWER[axis]];
    }
}

/* The plant h_s later, its modes unchanged. */
typedef struct {
    double h_s, x[N_STATES];
    step_stages seen;
} view;

static __attribute__((noinline)) void look(const moment *at, double h_s, view *then)
{
    then->h_s = h_s;
    rk4_step(at->t_s, h_s, &at->body, at->u, at->c, then->x, &then->seen);
}

/* How far `event` is in a stage of a step: positive before it, negative past it; the torque at the end is that of the last stage. */
static double break_margin(const step_stages *seen, int stage, int axis, int event)
{
    const double torque = seen->torque[stage][axis];
    return event == EVENT_BREAK_UP ? seen->up[stage][axis] - torque : torque + seen->down[stage][axis];
}

static double state_margin(const moment *at, const double *x, int axis, int event)
{
    switch (event) {
    case EVENT_REST:
        return at->body.sign[axis] * x[AXIS_VELOCITY[axis]];
    case EVENT_LOWER:
        return x[AXIS_POSITION[axis]] - at->c[AXIS_LOWER[axis]];
    case EVENT_KINK_UP:
        return -x[KINK_STATE[axis]];
    case EVENT_KINK_DOWN:
        return x[KINK_STATE[axis]];
    default:
        return at->c[AXIS_UPPER[axis]] - x[AXIS_POSITION[axis]];
    }
}

static double margin(const moment *at, const view *then, int axis, int event)
{
    return is_break(event) ? break_margin(&then->seen, 3, axis, event) : state_margin(at, then->x, axis, event);
}

/* The margin after h_s, with the torque of a held axis taken at the very state reached. */
static double margin_after(const moment *at, double h_s, int axis, int event, view *then)
{
    look(at, h_s, then);
    if (is_break(event))
        torques(at, then->x, at->t_s + h_s, then->seen.torque[3], then->seen.up[3], then->seen.down[3]);
    return margin(at, then, axis, event);
}

/* A margin within a step as a cubic of the fraction of the step: values and slopes at both ends. */
typedef struct {
    double value_0, slope_0, square, cube;
} cubic;

static double cubic_slope(const cubic *g, double s)
{
    return g->slope_0 + s * (2.0 * g->square + 3.0 * s * g->cube);
}

static double cubic_value(const cubic *g, double s)
{
    return g->value_0 + s * (g->slope_0 + s * (g->square + s * g->cube));
}

static cubic margin_cubic(const moment *at, const view *end, int axis, int event)
{
    const step_stages *const seen = &end->seen;
    if (is_kink(event)) { /* a chord; Newton's method does the rest */
        const double before = state_margin(at, at->body.x, axis, event), after = state_margin(at, end->x, axis, event);
        return (cubic){before, after - before, 0.0, 0.0};
    }
    const int velocity = AXIS_VELOCITY[axis];
    const double direction = event == EVENT_REST ? at->body.sign[axis] : event == EVENT_LOWER ? 1.0 : -1.0;
    double first, last = margin(at, end, axis, event), slope_0, slope_1;
    if (is_break(event)) { /* through the ends and the two middle stages' mean */
        first = break_margin(seen, 0, axis, event);
        const double middle = 0.5 * (break_margin(seen, 1, axis, event) + break_margin(seen, 2, axis, event));
        slope_0 = 4.0 * middle - 3.0 * first - last;
        slope_1 = first - 4.0 * middle + 3.0 * last;
    } else {
        first = state_margin(at, at->body.x, axis, event);
        slope_0 = direction * end->h_s * (event == EVENT_REST ? seen->start[axis] : at->body.x[velocity]);
        slope_1 = direction * end->h_s * (event == EVENT_REST ? seen->end[axis] : end->x[velocity]);
    }
    return (cubic){first, slope_0, 3.0 * (last - first) - 2.0 * slope_0 - slope_1, 2.0 * (first - last) + slope_0 + slope_1};
}

/* A root of the cubic in (0, 1), positive at 0 and negative at 1: Newton's method within a shrinking bracket. */
static double cubic_root(const cubic *g)
{
    double low = 0.0, high = 1.0, s = g->value_0 / (g->value_0 - cubic_value(g, 1.0));
    for (int round = 0; round < 12; round++) {
        const double value = cubic_value(g, s), step = value / cubic_slope(g, s);
        if (value > 0.0)
            low = s;
        else
            high = s;
        if (fabs(step) < 1e-9)
            break;
        s = s - step > low && s - step < high ? s - step : 0.5 * (low + high);
    }
    return s;
}

/* Narrow [early, late] to an instant with a positive margin at its start, for a margin that starts at zero: that zero belongs to the
 * event just passed. Returns false when the margin is not positive anywhere before. */
static bool leave_zero(const moment *at, double noise, double *early, double *late, int axis, int event)
{
    view then;
    const double least = 1e-24 * *late; /* of the whole stretch: `late` comes nearer with each trial */
    for (double trial = 0.5 * *late; trial > least; trial *= 0.5) {
        if (margin_after(at, trial, axis, event, &then) > noise) {
            *early = trial;
            return true;
        }
        *late = trial;
    }
    *late = DBL_TRUE_MIN; /* it is past zero at once */
    return false;
}

/* The instant within the step to `end` at which the margin of `event`, past zero there, goes through zero: the root of the cubic, improved
 * by secants, halving where they do not help. `then` is the plant at that instant. */
static void locate(const moment *at, const view *end, int axis, int event, view *then)
{
    const cubic g = margin_cubic(at, end, axis, event);
    const double noise = 1e-10 * (fabs(g.value_0) + fabs(cubic_value(&g, 1.0)));
    double early = 0.0, late = end->h_s, at_h = late, slope = -1.0, last = INFINITY, last_h = 0.0;
    if (g.value_0 > noise && cubic_value(&g, 1.0) < 0.0) {
        const double s = cubic_root(&g);
        at_h = s * late;
        slope = cubic_slope(&g, s) / late;
    } else if (!(g.value_0 > noise) && !leave_zero(at, noise, &early, &late, axis, event)) {
        at_h = late;
        early = late;
    }
    for (int round = 0; round < 60; round++) {
        const double value = margin_after(at, at_h, axis, event, then);
        if (fabs(value) <= noise || !(late - early > 1e-14 * end->h_s))
            break;
        if (value > 0.0)
            early = at_h;
        else
            late = at_h;
        if (round > 0 && value != last)
            slope = (value - last) / (at_h - last_h);
        const double next = at_h - value / slope;
        const bool helps = fabs(value) < 0.5 * fabs(last) && next > early && next < late;
        last = value;
        last_h = at_h;
        at_h = helps ? next : 0.5 * (early + late);
    }
}

#endif
