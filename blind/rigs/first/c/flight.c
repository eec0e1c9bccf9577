/* A flight of the rig, with shadows: other models that start anew from where the rig stands at the head of each window and
 * then run freely, without gusts, on the same commands. A shadow inherits every inner state of the rig; a `placed` one, whose
 * sensors differ from the rig's, then starts from what the rig's sensors show. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "truth.h"

static const double STEP_S = 100e-6;
enum { GUSTS_PER_ROW = 10, SHADOW_PLACED = 1, SHADOW_LOSES = 2 };

static void apparent_state(const state_t *s, double *out)
{
    for (int i = 0; i < 2; i++) {
        out[2 * i] = s->read[i];
        out[2 * i + 1] = s->read_rate[i];
        out[4 + i] = s->omega[i];
    }
}

static void place(const effects_t *fx, state_t *s, const double *apparent)
{
    for (int i = 0; i < 2; i++) {
        s->angle[i] = apparent[2 * i];
        s->rate[i] = apparent[2 * i + 1];
        s->omega[i] = apparent[4 + i];
    }
    sensor_reset(fx, s);
}

static void advance(const rig_t *rig, const effects_t *fx, state_t *s, int steps, const double *gust_Nm, double dt)
{
    static const double calm[2] = {0.0, 0.0};
    int moves = sensor_moves(fx);
    rig_slow(fx, s);
    for (int step = 0; step < steps; step++) {
        int slot = step * GUSTS_PER_ROW / steps;
        rig_step(rig, fx, s, gust_Nm ? gust_Nm + 2 * slot : calm, dt);
        if (moves || step + 1 == steps)
            sensor_step(fx, s, dt);
    }
}

static void start_state(const effects_t *fx, const double start[6], double t_s, state_t *s)
{
    memset(s, 0, sizeof *s);
    s->t_s = t_s;
    place(fx, s, start);
}

static void settle_driver(state_t *s, const double u_V[2])
{
    for (int i = 0; i < 2; i++)
        s->pipe[i].now_V = s->slewed_V[i] = s->lagged_V[i] = s->played_V[i] = u_V[i];
    s->load_V = fabs(u_V[0]) + fabs(u_V[1]);
}

static void measure(const rig_t *rig, const effects_t *fx, const state_t *s, int row, record_t *out)
{
    out->t_s[row] = s->t_s;
    for (int i = 0; i < 2; i++) {
        out->y_rad[2 * row + i] = sensor_count(rig, fx, s, i);
        out->exact_rad[2 * row + i] = s->read[i];
    }
    apparent_state(s, out->apparent + 6 * row);
}

static void follow(int shadows, const effects_t *fxs, const unsigned char *mode, state_t *shadow, const state_t *s,
                   const double *apparent, int renew, double *out)
{
    for (int k = 0; k < shadows; k++) {
        if (renew) {
            shadow[k] = *s;
            if (mode[k] & SHADOW_PLACED)
                place(&fxs[k], &shadow[k], apparent);
        }
        out[2 * k] = shadow[k].read[0];
        out[2 * k + 1] = shadow[k].read[1];
    }
}

void fly(const rig_t *rig, const effects_t *fx, const rig_t *nominal, const pilot_t *pilot, const flight_t *flight, const double start[6],
         int shadows, const rig_t *shadow_rig, const effects_t *shadow_fx, const unsigned char *mode, int window, record_t *out)
{
    state_t *all = malloc((size_t)(shadows + 1) * sizeof *all), *s = all, *shadow = all + 1;
    pilot_state_t p;
    double u_V[2];
    out->at_stop = out->failed = 0;
    if (!all) {
        out->failed = 1;
        return;
    }
    start_state(fx, start, -0.01 * flight->settle, s);
    for (int row = 0; row < flight->rows && !out->failed; row++) {
        int steps = flight->substeps[row];
        measure(rig, fx, s, row, out);
        follow(shadows, shadow_fx, mode, shadow, s, out->apparent + 6 * row, (row - flight->settle) % window == 0,
               out->shadow + 2 * shadows * row);
        if (row == 0)
            pilot_reset(pilot, out->y_rad, &p);
        pilot_step(pilot, nominal, flight->reference + 2 * row, out->y_rad + 2 * row, flight->dither_V + 2 * row, 0.01, &p, u_V);
        memcpy(out->u_V + 2 * row, u_V, sizeof u_V);
        if (row == 0)
            settle_driver(s, u_V);
        if (!flight->lost[row])
            rig_command(fx, s, u_V);
        advance(rig, fx, s, steps, flight->gust_Nm + 2 * GUSTS_PER_ROW * row, STEP_S);
        for (int k = 0; k < shadows && row >= flight->settle; k++) {
            if (!(mode[k] & SHADOW_LOSES) || !flight->lost[row])
                rig_command(&shadow_fx[k], &shadow[k], u_V);
            advance(&shadow_rig[k], &shadow_fx[k], &shadow[k], steps, 0, STEP_S);
        }
        out->at_stop += fabs(s->angle[0]) >= rig->stop_rad[0];
        out->failed = !(isfinite(s->angle[0]) && isfinite(s->angle[1]) && isfinite(s->omega[0] + s->omega[1]));
    }
    free(all);
}

/* Free runs of an effect-free rig over recorded rows, anew from the recorded state at the head of each window; out (rows, 2). */
void predict(const rig_t *rig, int rows, const double *t_s, const double *u_V, const double *apparent, int window, double dt, double *out)
{
    static const effects_t none;
    static const double calm[2] = {0.0, 0.0};
    state_t *s = malloc(sizeof *s);
    for (int row = 0; row < rows && s; row++) {
        if (row % window == 0) {
            memset(s, 0, sizeof *s);
            for (int i = 0; i < 2; i++) {
                s->angle[i] = apparent[6 * row + 2 * i];
                s->rate[i] = apparent[6 * row + 2 * i + 1];
                s->omega[i] = apparent[6 * row + 4 + i];
                s->bristle[i] = s->rate[i] == 0.0 ? 0.0 : copysign(1.0e-5, s->rate[i]);
            }
            rig_slow(&none, s);
        }
        out[2 * row] = s->angle[0];
        out[2 * row + 1] = s->angle[1];
        if (row + 1 == rows)
            break;
        double span = t_s[row + 1] - t_s[row];
        int steps = (int)(span / dt + 0.5) > 0 ? (int)(span / dt + 0.5) : 1;
        for (int i = 0; i < 2; i++)
            s->pipe[i].now_V = u_V[2 * row + i];
        for (int step = 0; step < steps; step++)
            rig_step(rig, &none, s, calm, span / steps);
    }
    free(s);
}
