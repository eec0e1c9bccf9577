/* See events.h. */
#define LANES 1
#include "events.h"

#include "step.h"

typedef struct {
    plant_body body;
    double t_s;
    const double *u, *c;
} moment;

static double torque_of(const moment *at, const double *x, double t_s, int axis, double *up, double *down)
{
    double dx[N_STATES], torque[AXES], ups[AXES], downs[AXES];
    model_rates(t_s, x, at->u, at->c, at->body.sign, at->body.move, dx, torque, ups, downs);
    *up = ups[axis];
    *down = downs[axis];
    return torque[axis];
}

/* An axis at rest: held while its torque is within breakaway, or towards a stop that it lies against. */
static void settle_axis(moment *at, int axis)
{
    double *const x = at->body.x;
    double up, down;
    const double torque = torque_of(at, x, at->t_s, axis, &up, &down);
    const bool below = x[AXIS_POSITION[axis]] <= at->c[AXIS_LOWER[axis]];
    const bool above = x[AXIS_POSITION[axis]] >= at->c[AXIS_UPPER[axis]];
    const bool free = !(up + down > 0.0) && !below && !above; /* no friction: passes through rest */
    const int direction = torque > up && !above ? 1 : torque < -down && !below ? -1 : 0;
    at->body.move[axis] = free || direction != 0;
    at->body.sign[axis] = up + down > 0.0 ? direction : 0.0;
}

static void settle_all(moment *at)
{
    double *const x = at->body.x;
    for (int a = 0; a < N_AXES; a++) {
        const double lower = at->c[AXIS_LOWER[a]], upper = at->c[AXIS_UPPER[a]];
        double *const position = &x[AXIS_POSITION[a]], *const velocity = &x[AXIS_VELOCITY[a]];
        if ((*position <= lower && *velocity < 0.0) || (*position >= upper && *velocity > 0.0))
            *velocity = 0.0;
        *position = *position < lower ? lower : *position > upper ? upper : *position;
        at->body.move[a] = 1.0;
        at->body.sign[a] = *velocity > 0.0 ? 1.0 : -1.0;
    }
    for (int a = 0; a < N_AXES; a++) {
        double up, down;
        torque_of(at, x, at->t_s, a, &up, &down);
        if (x[AXIS_VELOCITY[a]] == 0.0)
            settle_axis(at, a);
        else if (!(up + down > 0.0))
            at->body.sign[a] = 0.0;
    }
}

/* Whether `event` can end the present motion of `axis`. */
static bool watched(const moment *at, int axis, int event)
{
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
    double x[N_STATES], torque[AXES], up[AXES], down[AXES];
    step_stages seen;
} view;

static view look(const moment *at, double h_s)
{
    view then;
    double dx[N_STATES];
    rk4_step(at->t_s, h_s, &at->body, at->u, at->c, then.x, &then.seen);
    model_rates(at->t_s + h_s, then.x, at->u, at->c, at->body.sign, at->body.move, dx, then.torque, then.up, then.down);
    return then;
}

/* How far `event` still is: positive before it, negative past it. */
static double margin(const moment *at, const view *then, int axis, int event)
{
    switch (event) {
    case EVENT_REST:
        return at->body.sign[axis] * then->x[AXIS_VELOCITY[axis]];
    case EVENT_LOWER:
        return then->x[AXIS_POSITION[axis]] - at->c[AXIS_LOWER[axis]];
    case EVENT_UPPER:
        return at->c[AXIS_UPPER[axis]] - then->x[AXIS_POSITION[axis]];
    case EVENT_BREAK_UP:
        return then->up[axis] - then->torque[axis];
    default:
        return then->torque[axis] + then->down[axis];
    }
}

static double margin_after(const moment *at, double h_s, int axis, int event)
{
    const view then = look(at, h_s);
    return margin(at, &then, axis, event);
}

/* The instant within (0, late] at which `event` happens, its margin at `late` being past zero: regula falsi, halving the weight of an
 * end that stays (Illinois). A margin of zero at the start belongs to the event just passed; the search then starts behind it. */
static double locate(const moment *at, double late, int axis, int event)
{
    double early = 0.0, before = margin_after(at, 0.0, axis, event), after = margin_after(at, late, axis, event);
    const double noise = 1e-13 * (fabs(before) + fabs(after));
    for (double trial = 0.5 * late; before <= noise && trial > 1e-12 * late; trial *= 0.5) {
        const double value = margin_after(at, trial, axis, event);
        if (value > noise) {
            early = trial;
            before = value;
        } else {
            late = trial;
            after = value;
        }
    }
    if (before <= 0.0)
        return late;
    double kept = 0.0;
    for (int round = 0; round < 60 && late - early > 1e-15 * late && after < 0.0; round++) {
        const double trial = late - after * (late - early) / (after - before);
        const double value = margin_after(at, trial, axis, event);
        if (value > 0.0) {
            early = trial;
            before = value;
            after = kept > 0.0 ? 0.5 * after : after;
            kept = 1.0;
        } else {
            late = trial;
            after = value;
            before = kept < 0.0 ? 0.5 * before : before;
            kept = -1.0;
        }
        if (fabs(value) <= 1e-2 * noise)
            return trial;
    }
    return late;
}

/* Where within h_s an axis may have been past an event although it is not at the end: the lowest point of the velocity's cubic through
 * both ends, or the middle for a held axis; 0 where there is none. */
static double doubtful_instant(const moment *at, double h_s, int axis, const view *end)
{
    if (at->body.move[axis] == 0.0)
        return 0.5 * h_s;
    const double sign = at->body.sign[axis];
    const double v0 = sign * at->body.x[AXIS_VELOCITY[axis]], v1 = sign * end->x[AXIS_VELOCITY[axis]];
    const double a0 = sign * end->seen.start[axis] * h_s, a1 = sign * end->seen.end[axis] * h_s;
    if (!(v0 > 0.0 && a0 < 0.0 && a1 > 0.0)) /* an axis that has just broken away starts at v0 = 0 and gathers speed */
        return 0.0;
    const double cubic = 3.0 * (2.0 * (v0 - v1) + a0 + a1), square = 3.0 * (v1 - v0) - 2.0 * a0 - a1;
    return h_s * (-a0) / (square + sqrt(fmax(square * square - cubic * a0, 0.0)));
}

typedef struct {
    double h_s;
    int axis, event;
} next_event;

static bool passed(const moment *at, const view *then, double h_s, const next_event *known, next_event *found)
{
    for (int a = 0; a < N_AXES; a++)
        for (int event = EVENT_REST; event <= EVENT_BREAK_DOWN; event++) {
            if ((known->event == event && known->axis == a) || !watched(at, a, event))
                continue;
            const double value = margin(at, then, a, event);
            if (value < 0.0 || (value == 0.0 && event == EVENT_REST)) {
                *found = (next_event){h_s, a, event};
                return true;
            }
        }
    return false;
}

static bool passed_within(const moment *at, const view *end, double h_s, const next_event *known, next_event *found)
{
    for (int a = 0; a < N_AXES; a++) {
        const double instant = doubtful_instant(at, h_s, a, end);
        if (instant > 0.0 && instant < h_s) {
            const view then = look(at, instant);
            if (passed(at, &then, instant, known, found))
                return true;
        }
    }
    return false;
}

/* The first event within h_s, or EVENT_NONE at h_s, and the plant at that instant. */
static next_event first_event(const moment *at, double h_s, view *then)
{
    next_event first = {h_s, 0, EVENT_NONE}, found;
    *then = look(at, h_s);
    if (!passed(at, then, h_s, &first, &found) && !passed_within(at, then, h_s, &first, &found))
        return first;
    for (int round = 0; round < 4 * AXES; round++) {
        first = (next_event){locate(at, found.h_s, found.axis, found.event), found.axis, found.event};
        *then = look(at, first.h_s);
        if (!passed(at, then, first.h_s, &first, &found))
            break;
    }
    return first;
}

static void apply(moment *at, const next_event *event)
{
    const int axis = event->axis;
    switch (event->event) {
    case EVENT_BREAK_UP:
    case EVENT_BREAK_DOWN:
        at->body.move[axis] = 1.0;
        at->body.sign[axis] = event->event == EVENT_BREAK_UP ? 1.0 : -1.0;
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
    settle_axis(at, axis);
}

static void hold_all(moment *at)
{
    for (int a = 0; a < N_AXES; a++) {
        at->body.x[AXIS_VELOCITY[a]] = 0.0;
        at->body.sign[a] = at->body.move[a] = 0.0;
    }
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

int events_advance(double *x, double *sign, double *move, double t_s, double h_s, const double *u, const double *c,
                   event_piece *pieces)
{
    moment at = {.t_s = t_s, .u = u, .c = c};
    load(&at, x, sign, move);
    settle_all(&at);
    int count = 0;
    for (double left = h_s;;) {
        if (count == MAX_EVENTS)
            hold_all(&at);
        view then;
        const next_event next = first_event(&at, left, &then);
        if (pieces)
            pieces[count] = (event_piece){at.t_s, next.h_s, next.axis, next.event};
        count++;
        for (int i = 0; i < N_STATES; i++)
            at.body.x[i] = then.x[i];
        if (next.event == EVENT_NONE || count > MAX_EVENTS)
            break;
        at.t_s += next.h_s;
        left -= next.h_s;
        apply(&at, &next);
    }
    store(&at, x, sign, move);
    return count;
}
