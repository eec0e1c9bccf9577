/* A flight of a rig. Beside it run shadows: other models that are set to the rig's whole state at the head of each window and then
 * go on without gusts on the same commands; one whose sensors differ starts from the angles and rates that the rig's sensors show. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simulation.h"

enum { STARTS_FROM_SHOWN = 1, LOSES_FRAMES = 2 };

static void measure(const model_t *m, state_t *s, int row, record_t *out)
{
    double x[6], *apparent = out->apparent + 6 * row;
    state_motion(s, x);
    out->t_s[row] = s->t_s;
    for (int i = 0; i < 2; i++) {
        out->y_rad[2 * row + i] = sensor_count(&m->rig, &m->effects, s, i);
        out->exact_rad[2 * row + i] = s->read[i];
        apparent[2 * i] = s->read[i];
        apparent[2 * i + 1] = s->read_rate[i];
        apparent[4 + i] = x[4 + i];
    }
}

static void renew(int shadows, const model_t *other, const unsigned char *mode, state_t *shadow, const state_t *s,
                  const double *apparent)
{
    for (int k = 0; k < shadows; k++) {
        shadow[k] = *s;
        if (mode[k] & STARTS_FROM_SHOWN)
            state_place(&other[k], apparent, &shadow[k]);
    }
}

/* Where a row leaves the rig: on a stop, or lost. */
static void judge(const model_t *m, const state_t *s, record_t *out)
{
    double x[6];
    state_motion(s, x);
    out->at_stop += fabs(x[0]) >= m->rig.stop_rad[0];
    out->failed = !isfinite(x[0] + x[2] + x[4] + x[5]);
}

void fly(const model_t *own, const rig_t *nominal, const control_t *control, const inputs_t *in, const double start[6],
         int shadows, const model_t *other, const unsigned char *mode, int window, record_t *out)
{
    state_t *all = malloc((size_t)(shadows + 1) * sizeof *all), *s = all, *shadow = all + 1;
    control_state_t k;
    double u_V[2];
    out->at_stop = 0;
    out->failed = !all;
    if (all)
        state_begin(own, start, -in->settle * control->period_s, s);
    for (int row = 0; row < in->rows && !out->failed; row++) {
        measure(own, s, row, out);
        if (row >= in->settle && (row - in->settle) % window == 0)
            renew(shadows, other, mode, shadow, s, out->apparent + 6 * row);
        if (row == 0)
            control_start(control, in->reference, out->y_rad, &k);
        control_step(control, nominal, in->reference + 2 * row, out->y_rad + 2 * row, in->dither_V + 2 * row, &k, u_V);
        memcpy(out->u_V + 2 * row, u_V, sizeof u_V);
        if (row == 0)
            commands_settle(s, u_V);
        if (!in->lost[row])
            commands_send(s, u_V);
        state_advance(own, s, in, row, 1);
        for (int i = 0; i < shadows && row >= in->settle; i++) {
            memcpy(out->shadow + 2 * (shadows * row + i), shadow[i].read, 2 * sizeof(double));
            if (!(mode[i] & LOSES_FRAMES) || !in->lost[row])
                commands_send(&shadow[i], u_V);
            state_advance(&other[i], &shadow[i], in, row, 0);
        }
        judge(own, s, out);
    }
    free(all);
}

double bristle_width(const model_t *m, int axis)
{
    return m->bearing.width[axis];
}
