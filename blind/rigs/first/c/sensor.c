/* From an axis to the number that its encoder counts. */
#include <math.h>

#include "simulation.h"

/* The shaft on which the encoder sits: behind a light spring, bent scales, play. Order: mode, cyclic error, cross talk, scale, lag, delay, play. */
static void shaft(const effects_t *fx, state_t *s, int axis, double *angle, double *rate)
{
    double x = s->angle[axis] + fx->flex[axis] * (s->flex[axis] - s->angle[axis]);
    double gain = 1.0 + fx->scale_error[axis];
    if (fx->cyclic_rad[axis] != 0.0)
        x += fx->cyclic_rad[axis] * sin(fx->cyclic_count[axis] * s->angle[axis] + fx->cyclic_phase[axis]);
    x += fx->cross[axis] * s->angle[1 - axis];
    *angle = gain * x + fx->offset_rad[axis] + (fx->slip_rad[axis] != 0.0 && s->t_s >= fx->slip_time_s[axis] ? fx->slip_rad[axis] : 0.0);
    *rate = gain * (s->rate[axis] + fx->cross[axis] * s->rate[1 - axis]);
}

static void bend(const effects_t *fx, state_t *s, int axis, double dt)
{
    double w = fx->flex_rad_s[axis], stretch = s->angle[axis] - s->flex[axis], slip = s->rate[axis] - s->flex_rate[axis];
    s->flex_rate[axis] += dt * (w * w * stretch + 2.0 * fx->flex_zeta[axis] * w * slip);
    s->flex[axis] += dt * s->flex_rate[axis];
}

/* Whether what the encoder shows depends on the past: if not, it need only be known at the samples. */
int sensor_moves(const effects_t *fx)
{
    int moves = 0;
    for (int i = 0; i < 2; i++)
        moves |= fx->flex[i] != 0.0 || fx->sensor_lag_s[i] > 0.0 || fx->sensor_delay_s[i] > 0.0 || fx->backlash_rad[i] > 0.0;
    return moves;
}

void sensor_step(const effects_t *fx, state_t *s, double dt)
{
    for (int axis = 0; axis < 2; axis++) {
        double angle, rate;
        if (fx->flex[axis] != 0.0)
            bend(fx, s, axis, dt);
        shaft(fx, s, axis, &angle, &rate);
        if (fx->sensor_lag_s[axis] > 0.0) {
            rate = (angle - s->lagged[axis]) / fx->sensor_lag_s[axis];
            angle = s->lagged[axis] += dt * rate;
        }
        if (fx->sensor_delay_s[axis] > 0.0)
            past_delay(&s->past[axis], fx->sensor_delay_s[axis], dt, &angle, &rate);
        if (fx->backlash_rad[axis] > 0.0) {
            double half = 0.5 * fx->backlash_rad[axis];
            angle = s->played[axis] = fmin(fmax(s->played[axis], angle - half), angle + half);
        }
        s->read[axis] = angle;
        s->read_rate[axis] = rate;
    }
}

/* Everything behind the axis starts as if it had rested there for ever. */
void sensor_reset(const effects_t *fx, state_t *s)
{
    for (int axis = 0; axis < 2; axis++) {
        double angle, rate;
        s->flex[axis] = s->angle[axis];
        s->flex_rate[axis] = s->rate[axis];
        shaft(fx, s, axis, &angle, &rate);
        s->lagged[axis] = s->played[axis] = s->read[axis] = angle;
        s->read_rate[axis] = rate;
        past_fill(&s->past[axis], angle, rate);
    }
}

double sensor_count(const rig_t *rig, const effects_t *fx, state_t *s, int axis)
{
    double y = s->read[axis], q = rig->resolution_rad[axis];
    if (fx->count_rad[axis] > 0.0)
        y = fx->count_rad[axis] * floor(y / fx->count_rad[axis] + 0.5);
    return q * floor(y / q + 0.5);
}
