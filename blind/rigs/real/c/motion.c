/* Steps by the midpoint rule with dry friction in the slope, whose bristles follow exactly; flights with shadows beside them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simulation.h"

enum { ARC_TANGENT = 0, DAHL = 1, LUGRE = 2, STARTS_FROM_SHOWN = 1, LOSES_FRAMES = 2 };
static const double BRISTLE_DAMPING_S = 2e-3;

static double friction(const model_t *m, const state_t *s, int axis, double rate)
{
    double level = dry_level(m, s, axis, rate), width = m->width[axis], part = s->bristle[axis] / width;
    if (level == 0.0)
        return 0.0;
    if (m->law == ARC_TANGENT)
        return level * atan(rate / width) / M_PI_2;
    if (m->law == LUGRE)
        part += BRISTLE_DAMPING_S * (rate - fabs(rate) * part) / width;
    return level * part;
}

static void slope(const model_t *m, const state_t *s, const double x[6], const double push[2], double dx[6])
{
    double torque[2], inertia[2];
    torques(m, s, x, torque, inertia, dx + 4);
    for (int axis = 0; axis < 2; axis++) {
        double angle = x[2 * axis], rate = x[2 * axis + 1];
        dx[2 * axis] = dx[2 * axis + 1] = 0.0;
        if (axis >= m->rig.axes || m->locked[axis])
            continue;
        torque[axis] += shared_torque(m, s, axis, angle, rate) - friction(m, s, axis, rate);
        dx[2 * axis] = rate;
        dx[2 * axis + 1] = torque[axis] / inertia[axis] + push[axis];
    }
}

static void stop(const model_t *m, state_t *s, int axis)
{
    double end = m->rig.stop[axis], *at = s->x + 2 * axis;
    if (end <= 0.0 || fabs(at[0]) < end)
        return;
    at[0] = copysign(end, at[0]);
    if (at[0] * at[1] > 0.0)
        at[1] = 0.0;
}

static void gyro(const model_t *m, state_t *s)
{
    if (m->rig.outputs > m->rig.axes)
        s->x[2] = s->x[1];
}

void plant_step(const model_t *m, state_t *s, const double push[2], double dt)
{
    double first[6], middle[6], dx[6];
    driver_step(m, s, dt);
    slope(m, s, s->x, push, first);
    for (int i = 0; i < 6; i++)
        middle[i] = s->x[i] + 0.5 * dt * first[i];
    slope(m, s, middle, push, dx);
    for (int i = 0; i < 6; i++)
        s->x[i] += dt * dx[i];
    for (int axis = 0; axis < m->rig.axes; axis++) {
        double full = copysign(m->width[axis], middle[2 * axis + 1]);
        if (m->law != ARC_TANGENT)
            s->bristle[axis] = full + (s->bristle[axis] - full) * exp(-fabs(middle[2 * axis + 1]) * dt / m->width[axis]);
        stop(m, s, axis);
    }
    gyro(m, s);
    s->t_s += dt;
}

void state_place(const model_t *m, const double x[6], state_t *s)
{
    memcpy(s->x, x, 6 * sizeof *x);
    for (int axis = 0; axis < 2; axis++)
        if (m->locked[axis])
            s->x[2 * axis + 1] = 0.0;
    gyro(m, s);
    sensor_rest(m, s);
}

void state_begin(const model_t *m, const double x[6], double t_s, state_t *s)
{
    memset(s, 0, sizeof *s);
    s->t_s = t_s;
    state_place(m, x, s);
}

void state_motion(const state_t *s, double x[6])
{
    memcpy(x, s->x, 6 * sizeof *x);
}

double bristle_width(const model_t *m, int axis)
{
    return m->width[axis];
}

static void measure(const model_t *m, const state_t *s, const run_t *run, int row, record_t *out)
{
    double *apparent = out->apparent + 6 * row;
    out->t_s[row] = s->t_s;
    for (int i = 0; i < m->rig.outputs; i++) {
        double shown = s->seen[i] + run->misread[2 * row + i];
        out->exact[2 * row + i] = shown;
        out->y[2 * row + i] = sensor_count(m, shown, run->resolution[i], i);
        apparent[2 * i] = s->seen[i];
        apparent[2 * i + 1] = s->seen_rate[i];
    }
    if (m->rig.outputs > m->rig.axes)
        apparent[1] = s->seen[1];
    apparent[4] = s->x[4];
    apparent[5] = s->x[5];
}

typedef struct {
    double last[2], rate[2], sum[2];
} law_t;

static void command(const model_t *m, const run_t *run, const double *y, int row, law_t *k, double u_V[2])
{
    for (int i = 0; i < m->rig.inputs; i++) {
        double wanted = run->base_V[2 * row + i], error = 0.0;
        if (run->closed) {
            error = run->reference[2 * row + i] - y[i];
            if (row == 0)
                k->last[i] = y[i];
            k->rate[i] += ((y[i] - k->last[i]) / run->period_s - k->rate[i]) * -expm1(-run->period_s / run->rate_filter_s);
            k->last[i] = y[i];
            if (m->locked[i])
                error = 0.0; /* the operator opens the loop of an axis that is held */
            wanted += run->gain[i][0] * error + run->gain[i][1] * k->sum[i] - run->gain[i][2] * k->rate[i];
        }
        double u = fmin(fmax(wanted, m->rig.low_V[i]), m->rig.high_V[i]);
        if (u == wanted)
            k->sum[i] += run->period_s * error;
        u_V[i] = fmin(fmax(run->bit_V[i] * rint(u / run->bit_V[i]), m->rig.low_V[i]), m->rig.high_V[i]);
    }
}

static void advance(const model_t *m, const run_t *run, state_t *s, int row, int pushed)
{
    const double *here = run->push + 2 * row;
    for (int step = 0; step < run->steps; step++) {
        double part = (step + 0.5) / run->steps, push[2] = {0.0, 0.0};
        for (int i = 0; i < 2 && pushed; i++)
            push[i] = here[i] + part * (here[2 + i] - here[i]);
        plant_step(m, s, push, run->step_s);
        sensor_step(m, s, run->step_s);
    }
}

void fly(const model_t *own, const run_t *run, const double start[6], int shadows, const model_t *other,
         const unsigned char *mode, int window, record_t *out)
{
    state_t *s = malloc((size_t)(shadows + 1) * sizeof *s), *shadow = s + 1;
    law_t law = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    double u_V[2] = {0.0, 0.0};
    out->at_stop = 0;
    out->failed = !s;
    if (s)
        state_begin(own, start, -run->settle * run->period_s, s);
    for (int row = 0; row < run->rows && !out->failed; row++) {
        measure(own, s, run, row, out);
        for (int k = 0; k < shadows && row >= run->settle && (row - run->settle) % window == 0; k++) {
            shadow[k] = *s;
            if (mode[k] & STARTS_FROM_SHOWN)
                state_place(&other[k], out->apparent + 6 * row, &shadow[k]);
        }
        command(own, run, out->y + 2 * row, row, &law, u_V);
        memcpy(out->u_V + 2 * row, u_V, sizeof u_V);
        if (row == 0)
            commands_settle(s, u_V);
        if (!run->lost[row])
            commands_send(s, u_V);
        advance(own, run, s, row, 1);
        for (int k = 0; k < shadows && row >= run->settle; k++) {
            memcpy(out->shadow + 2 * (shadows * row + k), shadow[k].seen, sizeof shadow[k].seen);
            if (!(mode[k] & LOSES_FRAMES) || !run->lost[row])
                commands_send(&shadow[k], u_V);
            advance(&other[k], run, &shadow[k], row, 0);
        }
        for (int axis = 0; axis < own->rig.axes; axis++)
            out->at_stop += own->rig.stop[axis] > 0.0 && fabs(s->x[2 * axis]) >= own->rig.stop[axis];
        out->failed = !isfinite(s->x[0] + s->x[2] + s->x[4] + s->x[5]) || fabs(s->x[0]) > own->rig.lost || fabs(s->x[2]) > own->rig.lost;
    }
    free(s);
}
