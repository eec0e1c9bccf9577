/* From an axis to the number in its log. */
#include <math.h>

#include "simulation.h"

enum { PAST = 1024 };

static void shaft(const model_t *m, const state_t *s, int axis, double *angle, double *rate)
{
    const effects_t *fx = &m->effects;
    double x = s->x[2 * axis], t = fmax(s->t_s, 0.0);
    *angle = x * (1.0 + fx->scale_error[axis]) + fx->offset[axis] + fx->wander[axis] * t - s->lost_angle[axis];
    if (fx->cyclic[axis] != 0.0)
        *angle += fx->cyclic[axis] * sin(fx->cyclic_waves[axis] * x);
    if (fx->jump[axis] != 0.0 && t > fx->jump_time_s[axis])
        *angle += fx->jump[axis];
    *rate = s->x[2 * axis + 1] * (1.0 + fx->scale_error[axis]);
}

void sensor_rest(const model_t *m, state_t *s)
{
    for (int axis = 0; axis < m->rig.outputs; axis++) {
        double angle, rate;
        s->lost_angle[axis] = 0.0;
        shaft(m, s, axis, &angle, &rate);
        s->seen[axis] = s->shown[axis] = s->slow[axis] = s->held[axis] = s->filtered[axis] = angle;
        s->seen_rate[axis] = rate;
        for (int i = 0; i < PAST; i++) /* as if it had come here at this rate */
            s->past[i][axis] = angle;
    }
}

static double delayed(const model_t *m, state_t *s, int axis, double angle, double dt)
{
    double back = m->effects.sensor_delay_s[axis] / dt;
    int whole = (int)back;
    s->past[s->now][axis] = angle;
    double newer = s->past[(s->now - whole + PAST) % PAST][axis];
    double older = s->past[(s->now - whole - 1 + PAST) % PAST][axis];
    return newer + (back - whole) * (older - newer);
}

void sensor_step(const model_t *m, state_t *s, double dt)
{
    const effects_t *fx = &m->effects;
    s->now = (s->now + 1) % PAST;
    for (int axis = 0; axis < m->rig.outputs; axis++) {
        double angle, rate, before = s->shown[axis];
        s->lost_angle[axis] += fx->missed[axis] * fabs(s->volts[axis]) * s->x[2 * axis + 1] * dt;
        shaft(m, s, axis, &angle, &rate);
        if (fx->sensor_lag_s[axis] > 0.0)
            angle = s->slow[axis] += (angle - s->slow[axis]) * -expm1(-dt / fx->sensor_lag_s[axis]);
        if (fx->sensor_delay_s[axis] > 0.0)
            angle = delayed(m, s, axis, angle, dt);
        if (fx->backlash[axis] > 0.0) {
            double half = 0.5 * fx->backlash[axis];
            s->held[axis] = fmin(fmax(s->held[axis], angle - half), angle + half);
            angle = s->held[axis];
        } else if (fx->sensor_lag_s[axis] > 0.0 || fx->sensor_delay_s[axis] > 0.0) {
            rate = (angle - before) / dt;
        }
        s->shown[axis] = angle;
        if (m->filter_s[axis] > 0.0)
            angle = s->filtered[axis] += (angle - s->filtered[axis]) * -expm1(-dt / m->filter_s[axis]);
        s->seen[axis] = angle;
        s->seen_rate[axis] = rate;
    }
}

double sensor_count(const model_t *m, double shown, double resolution, int axis)
{
    double coarse = m->effects.count[axis];
    if (coarse > 0.0)
        shown = coarse * floor(shown / coarse + 0.5);
    return resolution * floor(shown / resolution + 0.5);
}
