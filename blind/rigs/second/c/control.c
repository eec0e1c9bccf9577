/* The second rig's controllers: PID, cascade, or state feedback, each with a static feed-forward and a filtered
 * derivative. */
#include <math.h>

#include "simulation.h"

enum { PID = 0, CASCADE = 1, FEEDBACK = 2 };

static double parabola(const double p[3], double x)
{
    return p[0] + x * (p[1] + x * p[2]);
}

void control_start(const control_t *c, const double r_rad[2], const double y_rad[2], control_state_t *k)
{
    for (int i = 0; i < 2; i++) {
        k->last[i] = y_rad[i];
        k->rate[i] = k->sum[i] = 0.0;
        k->speed[i] = parabola(c->feed_rad_s[i], r_rad[0]);
    }
}

static double clipped(double x, double size)
{
    return fmin(fmax(x, -size), size);
}

/* What the integral collects: the error of the angle, or in a cascade that of the rate. */
static double collected(const control_t *c, int i, double error, double rate)
{
    return c->kind == CASCADE ? clipped(c->gain[i][0] * error, c->rate_limit_rad_s) - rate : error;
}

static double feedback(const control_t *c, int i, double psi_ref, double error, const control_state_t *k)
{
    const double *g = c->gain[i];
    if (c->kind == CASCADE)
        return g[1] * collected(c, i, error, k->rate[i]) + g[2] * k->sum[i];
    double u = g[0] * error + g[1] * k->sum[i] - g[2] * k->rate[i];
    return c->kind == FEEDBACK ? u - g[3] * (k->speed[i] - parabola(c->feed_rad_s[i], psi_ref)) : u;
}

void control_step(const control_t *c, const rig_t *nominal, const double r_rad[2], const double y_rad[2],
                  const double dither_V[2], control_state_t *k, double u_V[2])
{
    double part = c->period_s / (c->rate_filter_s + c->period_s);
    for (int i = 0; i < 2; i++) {
        double error = r_rad[i] - y_rad[i];
        k->rate[i] += part * ((y_rad[i] - k->last[i]) / c->period_s - k->rate[i]);
        k->last[i] = y_rad[i];
        double wanted = parabola(c->feed_V[i], r_rad[0]) + feedback(c, i, r_rad[0], error, k) + dither_V[i];
        double u = fmin(fmax(wanted, nominal->u_min_V[i]), nominal->u_max_V[i]);
        double more = collected(c, i, error, k->rate[i]);
        /* At a limit only what leads away from it is collected. */
        if (u == wanted || (wanted - u) * more < 0.0)
            k->sum[i] += c->period_s * more;
        k->speed[i] += c->period_s * (nominal->drive[i] * u - rotor_damping(nominal, i, k->speed[i]) * k->speed[i]);
        u_V[i] = u;
    }
}
