/* Free runs. */
#include <math.h>
#include <stdlib.h>

#include "simulation.h"

/* The state of a rig that has moved like this for long: its bristles are stretched to the full. */
static void begin_moving(const model_t *m, const double x[6], state_t *s)
{
    state_begin(m, x, 0.0, s);
    for (int i = 0; i < 2; i++)
        s->bristle[i] = x[1 + 2 * i] == 0.0 ? 0.0 : copysign(bristle_width(m, i), x[1 + 2 * i]);
}

/* Free runs of an effect-free model over recorded rows, anew from the recorded state at the head of each window; out (rows, 2). */
void predict(const model_t *m, int rows, const double *t_s, const double *u_V, const double *apparent, int window,
             double dt, double *out)
{
    static const double calm[2] = {0.0, 0.0};
    state_t *s = malloc(sizeof *s);
    for (int row = 0; row < rows && s; row++) {
        double x[6];
        if (row % window == 0)
            begin_moving(m, apparent + 6 * row, s);
        state_motion(s, x);
        out[2 * row] = x[0];
        out[2 * row + 1] = x[2];
        if (row + 1 == rows)
            break;
        double span = t_s[row + 1] - t_s[row];
        int steps = (int)(span / dt + 0.5) > 0 ? (int)(span / dt + 0.5) : 1;
        commands_settle(s, u_V + 2 * row);
        for (int step = 0; step < steps; step++)
            plant_step(m, s, calm, span / steps);
    }
    free(s);
}
