/* The benchmark's own controller: scheduled state feedback with integral action on tracked rates and modelled rotor speeds. */
#include <math.h>

#include "simulation.h"

static double between(const control_t *c, const double *table, int stride, double psi_rad)
{
    double place = (psi_rad - c->from_rad) / c->step_rad;
    double last = c->points - 1;
    place = place < 0.0 ? 0.0 : (place > last ? last : place);
    int index = place >= last ? c->points - 2 : (int)place;
    double part = place - index;
    return table[index * stride] * (1.0 - part) + table[(index + 1) * stride] * part;
}

void control_start(const control_t *c, const double r_rad[2], const double y_rad[2], control_state_t *p)
{
    (void)r_rad;
    for (int axis = 0; axis < 2; axis++) {
        p->angle[axis] = y_rad[axis];
        p->rate[axis] = p->sum[axis] = 0.0;
        p->speed[axis] = between(c, c->rest_rad_s[axis], 1, y_rad[0]);
    }
}

static double feedback(const control_t *c, int axis, const double r_rad[2], const control_state_t *p)
{
    const double *gain = c->gain[axis][0];
    double error = r_rad[axis] - p->angle[axis];
    double speed_error = between(c, c->rest_rad_s[axis], 1, r_rad[0]) - p->speed[axis];
    return between(c, gain + 0, 4, r_rad[0]) * p->sum[axis] + between(c, gain + 1, 4, r_rad[0]) * error
         - between(c, gain + 2, 4, r_rad[0]) * p->rate[axis] + between(c, gain + 3, 4, r_rad[0]) * speed_error;
}

void control_step(const control_t *c, const rig_t *nominal, const double r_rad[2], const double y_rad[2],
                  const double dither_V[2], control_state_t *p, double u_V[2])
{
    double w = c->track_rad_s, period_s = c->period_s;
    for (int axis = 0; axis < 2; axis++) {
        double miss = y_rad[axis] - p->angle[axis];
        p->angle[axis] += period_s * (p->rate[axis] + 1.4 * w * miss);
        p->rate[axis] += period_s * w * w * miss;
        double wanted = between(c, c->rest_V[axis], 1, r_rad[0]) + feedback(c, axis, r_rad, p) + dither_V[axis];
        double u = fmin(fmax(wanted, nominal->u_min_V[axis]), nominal->u_max_V[axis]);
        double error = r_rad[axis] - y_rad[axis];
        if (u == wanted || (wanted - u) * error < 0.0)
            p->sum[axis] += period_s * error;
        double speed = p->speed[axis];
        p->speed[axis] += period_s * (nominal->drive[axis] * u - rotor_damping(nominal, axis, speed) * speed);
        u_V[axis] = u;
    }
}
