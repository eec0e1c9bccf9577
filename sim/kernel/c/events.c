/* See events.h. */
#define LANES 1
#if !defined MANY_RUNS && !defined EQUATIONS_ONCE
#define EQUATIONS_ONCE /* inside each caller a step with an event takes a fifth less, which is less than the compiler takes for one run */
#endif
#include "events.h"

#include <float.h>
#include <string.h>

#include "margin.h"

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

/* The torques and breakaway levels are those at `at`. */
static void settle_by(moment *at, const double *torque, const double *up, const double *down)
{
    double *const x = at->body.x;
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

static void settle_all(moment *at)
{
    double torque[AXES], up[AXES], down[AXES];
    torques(at, at->body.x, at->t_s, torque, up, down);
    settle_by(at, torque, up, down);
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

/* Settle by what a step that is known saw first; returns whether that changed nothing, so that the step in `whole` still holds. */
static bool settle_known(moment *at, const double *known, view *whole)
{
    const plant_body before = at->body;
    memcpy(whole->x, known, sizeof whole->x);
    memcpy(&whole->seen, known + N_STATES, sizeof whole->seen);
    settle_by(at, whole->seen.torque[0], whole->seen.up[0], whole->seen.down[0]);
    return memcmp(&before, &at->body, sizeof before) == 0;
}

int events_advance(double *x, double *sign, double *move, double t_s, double h_s, const double *u, const double *c,
                   const double *known, event_piece *pieces)
{
    moment at = {.t_s = t_s, .u = u, .c = c};
    view whole = {.h_s = h_s};
    load(&at, x, sign, move);
    const bool as_known = known && settle_known(&at, known, &whole);
    if (!known)
        settle_all(&at);
    int count = 0;
    for (double left = h_s;;) {
        view end, then;
        if (count == MAX_EVENTS)
            hold_resting(&at);
        if (count == 0 && as_known)
            end = whole;
        else
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
