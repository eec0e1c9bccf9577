/* From an axis to the number that its encoder gives. */
#include <math.h>

#include "simulation.h"

/* The encoder's own angle and rate: those of the arm, or of the hub that it drives through a spring. */
static void shaft(const effects_t *fx, const state_t *s, int axis, double *angle, double *rate)
{
    int at = fx->mass_reads[axis] != 0.0 ? 6 + 2 * axis : 2 * axis;
    double x = s->x[at], v = s->x[at + 1], t = s->t_s > 0.0 ? s->t_s : 0.0;
    double bent = 1.0 + fx->scale_error[axis] * (1.0 + fx->scale_bend[axis] * fabs(x));
    double offset = fx->offset_rad[axis] * (1.0 + fx->offset_swing[axis] * sin(x)) + fx->wander_rad_s[axis] * t;
    *angle = x * bent + offset + fx->pickup_rad_V[axis] * s->volts[axis] + s->missed_rad[axis];
    *rate = v * (bent + fx->scale_error[axis] * fx->scale_bend[axis] * fabs(x));
}

static double filtered(const effects_t *fx, state_t *s, int axis, double angle, double dt)
{
    double first_s = fx->sensor_lag_s[axis] * fx->sensor_split[axis], second_s = fx->sensor_lag_s[axis] - first_s;
    double *y = s->filtered[axis];
    y[0] += (angle - y[0]) * -expm1(-dt / first_s);
    y[1] += (y[0] - y[1]) * -expm1(-dt / second_s);
    return y[1];
}

/* The bus asks for the angle now and then: how old the answer is differs from 10 ms to 10 ms. */
static double age_s(const effects_t *fx, const state_t *s, int axis)
{
    double luck = 2.0 * scatter((int)floor(s->t_s / 0.01) + 977 * axis) - 1.0;
    return fx->sensor_delay_s[axis] * (1.0 + fx->sensor_spread[axis] * luck);
}

static double play(double *held, double angle, double half)
{
    return *held = fmin(fmax(*held, angle - half), angle + half);
}

/* Two gears in a row of which one has more play: the mean of two plays. */
static double geared(const effects_t *fx, state_t *s, int axis, double angle)
{
    double half = 0.5 * fx->backlash_rad[axis], split = fx->backlash_split[axis];
    double wide = play(&s->played[axis][0], angle, half * (1.0 + split));
    return 0.5 * (wide + play(&s->played[axis][1], angle, half * (1.0 - split)));
}

/* Lines that pass too fast are not all counted. */
static void miss(const effects_t *fx, state_t *s, int axis, double dt)
{
    double v = s->x[2 * axis + 1];
    if (fx->missed[axis] != 0.0 && fabs(v) > fx->missed_rad_s[axis])
        s->missed_rad[axis] -= dt * fx->missed[axis] * (v - copysign(fx->missed_rad_s[axis], v));
}

/* Whether what the encoder shows depends on the past: if not, it need only be known at the samples. */
int sensor_moves(const effects_t *fx)
{
    int moves = 0;
    for (int i = 0; i < 2; i++) {
        moves |= fx->sensor_lag_s[i] > 0.0 || fx->sensor_delay_s[i] > 0.0;
        moves |= fx->backlash_rad[i] > 0.0 || fx->missed[i] != 0.0;
    }
    return moves;
}

void sensor_step(const effects_t *fx, state_t *s, double dt)
{
    for (int axis = 0; axis < 2; axis++) {
        double angle, rate;
        miss(fx, s, axis, dt);
        shaft(fx, s, axis, &angle, &rate);
        if (fx->sensor_lag_s[axis] > 0.0) {
            double before = s->filtered[axis][1];
            angle = filtered(fx, s, axis, angle, dt);
            rate = (angle - before) / dt;
        }
        if (fx->sensor_delay_s[axis] > 0.0)
            past_delay(&s->past[axis], age_s(fx, s, axis), dt, &angle, &rate);
        if (fx->backlash_rad[axis] > 0.0)
            angle = geared(fx, s, axis, angle);
        s->read[axis] = angle;
        s->read_rate[axis] = rate;
    }
}

/* Everything behind the arm starts as if it had moved or rested with it for ever. */
void sensor_rest(const effects_t *fx, state_t *s)
{
    for (int axis = 0; axis < 2; axis++) {
        double angle, rate;
        s->x[6 + 2 * axis] = s->x[2 * axis];
        s->x[7 + 2 * axis] = s->x[2 * axis + 1];
        s->missed_rad[axis] = 0.0;
        shaft(fx, s, axis, &angle, &rate);
        for (int i = 0; i < 2; i++)
            s->filtered[axis][i] = s->played[axis][i] = angle;
        s->read[axis] = s->counted[axis] = angle;
        s->read_rate[axis] = rate;
        past_fill(&s->past[axis], angle, rate);
    }
}

/* A coarse disc with a trigger that holds its level a little beyond the edge, read through the stated steps. */
double sensor_count(const rig_t *rig, const effects_t *fx, state_t *s, int axis)
{
    double y = s->read[axis], q = rig->resolution_rad[axis], coarse = fx->count_rad[axis];
    if (coarse > 0.0) {
        if (fabs(y - s->counted[axis]) > coarse * (0.5 + fx->count_hold[axis]))
            s->counted[axis] = coarse * round(y / coarse);
        y = coarse * round(s->counted[axis] / coarse);
    }
    return q * floor(y / q + 0.5);
}
