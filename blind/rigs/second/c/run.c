/* A flight of the rig. Beside it run shadows: other models that are set to the rig's whole state at the head of each
 * window and then go on without gusts on the same commands; one whose sensors differ starts from the angles and rates
 * that the rig's sensors show. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rig.h"

enum { STARTS_FROM_SHOWN = 1, LOSES_FRAMES = 2 };

static void shown(const state_t *s, double *out)
{
    for (int i = 0; i < 2; i++) {
        out[2 * i] = s->read[i];
        out[2 * i + 1] = s->read_rate[i];
        out[4 + i] = s->x[4 + i];
    }
}

static void put(const effects_t *fx, state_t *s, const double *apparent)
{
    memcpy(s->x, apparent, 6 * sizeof *apparent);
    sensor_rest(fx, s);
}

static void begin(const effects_t *fx, const double start[6], double t_s, state_t *s)
{
    memset(s, 0, sizeof *s);
    s->t_s = t_s;
    put(fx, s, start);
    s->x[10] = s->x[5];
    s->x[11] = s->x[4];
    s->maxwell_rad = start[0];
    weather(fx, s);
}

static void go(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, const flight_t *flight,
               int row, int windy)
{
    static const double calm[2] = {0.0, 0.0};
    int moves = sensor_moves(fx), steps = flight->steps[row];
    for (int step = 0; step < steps; step++) {
        int slot = step / flight->slot_steps < flight->slots ? step / flight->slot_steps : flight->slots - 1;
        if (step % flight->slot_steps == 0)
            weather(fx, s);
        plant_step(rig, bearing, fx, s, windy ? flight->gust + 2 * (flight->slots * row + slot) : calm, flight->step_s);
        if (moves || step + 1 == steps)
            sensor_step(fx, s, flight->step_s);
    }
}

static void measure(const rig_t *rig, const effects_t *fx, state_t *s, int row, record_t *out)
{
    out->t_s[row] = s->t_s;
    for (int i = 0; i < 2; i++) {
        out->y_rad[2 * row + i] = sensor_count(rig, fx, s, i);
        out->exact_rad[2 * row + i] = s->read[i];
    }
    shown(s, out->apparent + 6 * row);
}

static void renew(int shadows, const effects_t *fx, const unsigned char *mode, state_t *shadow, const state_t *s,
                  const double *apparent)
{
    for (int k = 0; k < shadows; k++) {
        shadow[k] = *s;
        if (mode[k] & STARTS_FROM_SHOWN)
            put(&fx[k], &shadow[k], apparent);
    }
}

void fly(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, const rig_t *nominal,
         const control_t *control, const flight_t *flight, const double start[6], int shadows,
         const rig_t *shadow_rig, const effects_t *shadow_fx, const unsigned char *mode, int window, record_t *out)
{
    state_t *all = malloc((size_t)(shadows + 1) * sizeof *all), *s = all, *shadow = all + 1;
    control_state_t k;
    double u_V[2];
    out->at_stop = 0;
    out->failed = !all;
    if (all)
        begin(fx, start, -flight->settle * control->period_s, s);
    for (int row = 0; row < flight->rows && !out->failed; row++) {
        measure(rig, fx, s, row, out);
        if (row >= flight->settle && (row - flight->settle) % window == 0)
            renew(shadows, shadow_fx, mode, shadow, s, out->apparent + 6 * row);
        if (row == 0)
            control_start(control, flight->reference, out->y_rad, &k);
        control_step(control, nominal, flight->reference + 2 * row, out->y_rad + 2 * row,
                     flight->dither_V + 2 * row, &k, u_V);
        memcpy(out->u_V + 2 * row, u_V, sizeof u_V);
        if (row == 0)
            line_settle(s, u_V);
        if (!flight->lost[row])
            line_send(s, u_V);
        go(rig, bearing, fx, s, flight, row, 1);
        for (int i = 0; i < shadows && row >= flight->settle; i++) {
            memcpy(out->shadow + 2 * (shadows * row + i), shadow[i].read, 2 * sizeof(double));
            if (!(mode[i] & LOSES_FRAMES) || !flight->lost[row])
                line_send(&shadow[i], u_V);
            go(&shadow_rig[i], bearing, &shadow_fx[i], &shadow[i], flight, row, 0);
        }
        out->at_stop += fabs(s->x[0]) >= rig->stop_rad[0];
        out->failed = !isfinite(s->x[0] + s->x[2] + s->x[4] + s->x[5]);
    }
    free(all);
}

/* Free runs of an effect-free rig over recorded rows, anew from the recorded state at the head of each window; out
 * (rows, 2). */
void predict(const rig_t *rig, const bearing_t *bearing, int rows, const double *t_s, const double *u_V,
             const double *apparent, int window, double dt, double *out)
{
    static const effects_t none;
    static const double calm[2] = {0.0, 0.0};
    state_t *s = malloc(sizeof *s);
    for (int row = 0; row < rows && s; row++) {
        if (row % window == 0) {
            begin(&none, apparent + 6 * row, 0.0, s);
            for (int i = 0; i < 2; i++)
                s->bristle[i] = s->x[1 + 2 * i] == 0.0 ? 0.0 : copysign(bearing->width[i], s->x[1 + 2 * i]);
        }
        out[2 * row] = s->x[0];
        out[2 * row + 1] = s->x[2];
        if (row + 1 == rows)
            break;
        double span = t_s[row + 1] - t_s[row];
        int steps = (int)(span / dt + 0.5) > 0 ? (int)(span / dt + 0.5) : 1;
        line_settle(s, u_V + 2 * row);
        for (int step = 0; step < steps; step++)
            plant_step(rig, bearing, &none, s, calm, span / steps);
    }
    free(s);
}
