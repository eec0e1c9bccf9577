/* See events.h. */
#define LANES 1
#include "events.h"

#include <float.h>

#include "step.h"

typedef struct {
    plant_body body;
    double t_s;
    const double *u, *c;
} moment;

/* An axis at rest: held while its torque is within breakaway, or towards a stop that it lies against. */
static void settle_axis(moment *at, int axis, double torque, double up, double down)
{
    const double position = at->body.x[AXIS_POSITION[axis]];
    const bool below = position <= at->c[AXIS_LOWER[axis]], above = position >= at->c[AXIS_UPPER[axis]];
    const bool rubs = up + down > 0.0;
    const int direction = torque > up && !above ? 1 : torque < -down && !below ? -1 : 0;
    at->body.move[axis] = direction != 0 || (!rubs && !below && !above); /* without friction it passes through rest */
    at->body.sign[axis] = rubs ? direction : 0.0;
}

static void torques(const moment *at, const double *x, double t_s, double *torque, double *up, double *down)
{
    double dx[N_STATES];
    model_rates(t_s, x, at->u, at->c, at->body.sign, at->body.move, dx, torque, up, down);
}

static void settle_all(moment *at)
{
    double *const x = at->body.x;
    double torque[AXES], up[AXES], down[AXES];
    torques(at, x, at->t_s, torque, up, down);
    for (int a = 0; a < N_AXES; a++) {
        const double lower = at->c[AXIS_LOWER[a]], upper = at->c[AXIS_UPPER[a]];
        double *const position = &x[AXIS_POSITION[a]], *const velocity = &x[AXIS_VELOCITY[a]];
        if ((*position <= lower && *velocity < 0.0) || (*position >= upper && *velocity > 0.0))
            *velocity = 0.0;
        *position = *position < lower ? lower : *position > upper ? upper : *position;
        if (*velocity == 0.0) {
            settle_axis(at, a, torque[a], up[a], down[a]);
        } else {
            at->body.move[a] = 1.0;
            at->body.sign[a] = !(up[a] + down[a] > 0.0) ? 0.0 : *velocity > 0.0 ? 1.0 : -1.0;
        }
    }
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

static void look(const moment *at, double h_s, view *then)
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
    for (double trial = 0.5 * *late; trial > 1e-12 * *late; trial *= 0.5) {
        if (margin_after(at, trial, axis, event, &then) > noise) {
            *early = trial;
            return true;
        }
        *late = trial;
    }
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

/* Where within the step to `end` an axis may have been past an event although it is not at its end; 0 where that cannot be. For a moving
 * axis the lowest point of the velocity's cubic through both ends, for a held one the middle, if a middle stage saw it break away. */
static double doubtful_instant(const moment *at, int axis, const view *end)
{
    const double h_s = end->h_s;
    if (at->body.move[axis] == 0.0) {
        for (int event = EVENT_BREAK_UP; event <= EVENT_BREAK_DOWN; event++)
            for (int stage = 1; stage <= 2; stage++)
                if (watched(at, axis, event) && break_margin(&end->seen, stage, axis, event) < 0.0)
                    return 0.5 * h_s;
        return 0.0;
    }
    const double sign = at->body.sign[axis];
    const double v0 = sign * at->body.x[AXIS_VELOCITY[axis]], v1 = sign * end->x[AXIS_VELOCITY[axis]];
    const double a0 = sign * end->seen.start[axis] * h_s, a1 = sign * end->seen.end[axis] * h_s;
    if (!(v0 > 0.0 && a0 < 0.0 && a1 > 0.0)) /* an axis that has just broken away starts at v0 = 0 and gathers speed */
        return 0.0;
    const double cubic = 3.0 * (2.0 * (v0 - v1) + a0 + a1), square = 3.0 * (v1 - v0) - 2.0 * a0 - a1;
    return h_s * (-a0) / (square + sqrt(fmax(square * square - cubic * a0, 0.0)));
}

typedef struct {
    int axis, event;
} next_event;

static bool passed(const moment *at, const view *then, next_event known, next_event *found)
{
    for (int event = EVENT_REST; event <= EVENT_KINK_DOWN; event++)
        for (int a = 0; a < (is_kink(event) ? N_KINKS : N_AXES); a++) {
            if ((known.event == event && known.axis == a) || !watched(at, a, event))
                continue;
            const double value = margin(at, then, a, event);
            if (value < 0.0 || (value == 0.0 && event == EVENT_REST)) {
                *found = (next_event){a, event};
                return true;
            }
        }
    return false;
}

/* Whether an event may have been passed and taken back before `end`; `then` is the plant at such an instant. */
static bool passed_within(const moment *at, const view *end, view *then, next_event *found)
{
    const next_event none = {0, EVENT_NONE};
    for (int a = 0; a < N_AXES; a++) {
        const double instant = doubtful_instant(at, a, end);
        if (instant > 0.0 && instant < end->h_s) {
            look(at, instant, then);
            if (passed(at, then, none, found))
                return true;
        }
    }
    return false;
}

/* The first event on the way to `end`, or EVENT_NONE; `then` is the plant at that event, or at the end. */
static next_event first_event(const moment *at, const view *end, view *then)
{
    next_event first = {0, EVENT_NONE}, found;
    view past = *end;
    if (!passed(at, end, first, &found) && !passed_within(at, end, &past, &found)) {
        *then = *end;
        return first;
    }
    for (int round = 0; round < 4 * AXES; round++) {
        first = found;
        locate(at, &past, found.axis, found.event, then);
        if (!passed(at, then, first, &found))
            break;
        past = *then;
    }
    return first;
}

static void apply(moment *at, next_event event)
{
    const int axis = event.axis;
    switch (event.event) {
    case EVENT_KINK_UP:
    case EVENT_KINK_DOWN: /* just beyond, where sgn has its new value */
        at->body.x[KINK_STATE[axis]] = event.event == EVENT_KINK_UP ? DBL_MIN : -DBL_MIN;
        return;
    case EVENT_BREAK_UP:
    case EVENT_BREAK_DOWN:
        at->body.move[axis] = 1.0;
        at->body.sign[axis] = event.event == EVENT_BREAK_UP ? 1.0 : -1.0;
        return;
    case EVENT_LOWER:
        at->body.x[AXIS_POSITION[axis]] = at->c[AXIS_LOWER[axis]];
        break;
    case EVENT_UPPER:
        at->body.x[AXIS_POSITION[axis]] = at->c[AXIS_UPPER[axis]];
        break;
    default:
        break;
    }
    at->body.x[AXIS_VELOCITY[axis]] = 0.0;
    double torque[AXES], up[AXES], down[AXES];
    torques(at, at->body.x, at->t_s, torque, up, down);
    settle_axis(at, axis, torque[axis], up[axis], down[axis]);
}

/* The way out of a step with too many events: what is at rest now stays so. */
static void hold_resting(moment *at)
{
    for (int a = 0; a < N_AXES; a++)
        if (at->body.x[AXIS_VELOCITY[a]] == 0.0)
            at->body.sign[a] = at->body.move[a] = 0.0;
}

static void load(moment *at, const double *x, const double *sign, const double *move)
{
    for (int i = 0; i < N_STATES; i++)
        at->body.x[i] = x[i];
    for (int a = 0; a < N_AXES; a++) {
        at->body.sign[a] = sign[a];
        at->body.move[a] = move[a];
    }
}

static void store(const moment *at, double *x, double *sign, double *move)
{
    for (int i = 0; i < N_STATES; i++)
        x[i] = at->body.x[i];
    for (int a = 0; a < N_AXES; a++) {
        sign[a] = at->body.sign[a];
        move[a] = at->body.move[a];
    }
}

void events_settle(double *x, double *sign, double *move, double t_s, const double *u, const double *c)
{
    moment at = {.t_s = t_s, .u = u, .c = c};
    load(&at, x, sign, move);
    settle_all(&at);
    store(&at, x, sign, move);
}

void events_apply(double *x, double *sign, double *move, double t_s, const double *u, const double *c, event_piece piece)
{
    moment at = {.t_s = t_s, .u = u, .c = c};
    load(&at, x, sign, move);
    apply(&at, (next_event){piece.axis, piece.event});
    store(&at, x, sign, move);
}

int events_advance(double *x, double *sign, double *move, double t_s, double h_s, const double *u, const double *c,
                   event_piece *pieces)
{
    moment at = {.t_s = t_s, .u = u, .c = c};
    load(&at, x, sign, move);
    settle_all(&at);
    int count = 0;
    for (double left = h_s;;) {
        view end, then;
        if (count == MAX_EVENTS)
            hold_resting(&at);
        look(&at, left, &end);
        then = end;
        const next_event none = {0, EVENT_NONE}, next = count == MAX_EVENTS ? none : first_event(&at, &end, &then);
        if (pieces)
            pieces[count] = (event_piece){at.t_s, then.h_s, next.axis, next.event};
        count++;
        for (int i = 0; i < N_STATES; i++)
            at.body.x[i] = then.x[i];
        if (next.event == EVENT_NONE)
            break;
        at.t_s += then.h_s;
        left -= then.h_s;
        apply(&at, next);
    }
    store(&at, x, sign, move);
    return count;
}
