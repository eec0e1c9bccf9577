/* Dry friction of the two bearings by one of three laws, solved apart from the rest of the motion. */
#include <math.h>

#include "simulation.h"

enum { ELEVATION = 0, AZIMUTH = 1, ROUNDED = 0, PRESLIDING = 1, STICK_SLIP = 2 };

/* Where the rate of the body in the bearing stands: the arm's, or that of a hub which the arm drives through a
 * spring. */
static int rate_index(const effects_t *fx, int axis)
{
    return fx->mass_reads[axis] != 0.0 ? 7 + 2 * axis : 1 + 2 * axis;
}

static double inertia_of(const rig_t *rig, const effects_t *fx, const state_t *s, int axis)
{
    double whole = rig->inertia[axis] * (axis == AZIMUTH ? cos(s->x[0]) : 1.0);
    double share = fx->mass_share[axis];
    return whole * (fx->mass_reads[axis] != 0.0 ? share : 1.0 - share);
}

/* Torque that the bearing gives at most against a motion that goes the way of `towards`, N m. */
static double level_of(const rig_t *rig, const effects_t *fx, const state_t *s, int axis, double v, double towards)
{
    double level = rig->coulomb_Nm[axis];
    if (fx->stribeck_Nm[axis] != 0.0) {
        double x = v / fx->stribeck_rad_s[axis];
        level += fx->stribeck_Nm[axis] / (1.0 + x * x);
    }
    if (fx->asymmetry_Nm[axis] * towards > 0.0)
        level += fabs(fx->asymmetry_Nm[axis]);
    if (axis == ELEVATION && fx->spot_Nm != 0.0) {
        double x = (s->x[0] - fx->spot_rad) / fx->spot_width_rad;
        level += fx->spot_Nm / (1.0 + x * x);
    }
    if (axis == AZIMUTH && fx->brush_Nm != 0.0)
        level += fx->brush_Nm * 0.5 * (1.0 + cos(s->x[2] - fx->brush_rad));
    return level;
}

/* Karnopp 1985: a bearing within its band of rest sticks while the other torques stay below the level. */
void bearing_grip(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, const double gust[2])
{
    double dx[12];
    int known = 0;
    s->held[0] = s->held[1] = 0;
    for (int axis = 0; axis < 2; axis++) {
        int at = rate_index(fx, axis);
        if (bearing->law[axis] != STICK_SLIP || fabs(s->x[at]) >= bearing->width[axis])
            continue;
        if (!known++)
            slope(rig, fx, s, s->x, gust, dx);
        double push = dx[at] * inertia_of(rig, fx, s, axis);
        s->held[axis] = fabs(push) <= level_of(rig, fx, s, axis, 0.0, push);
        if (s->held[axis])
            s->x[at] = 0.0;
    }
}

/* Dahl 1968: the bristle stretches with the motion and gives way at its width; torque in proportion to its stretch. */
static double dahl(state_t *s, int axis, double v, double drop, double width, double dt)
{
    double full = copysign(width, v);
    s->bristle[axis] = full + (s->bristle[axis] - full) * exp(-fabs(v) * dt / width);
    return v - drop * s->bristle[axis] / width;
}

static double sliding(double v, double drop)
{
    return fabs(v) <= drop ? 0.0 : v - copysign(drop, v);
}

void bearing_step(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, double dt)
{
    for (int axis = 0; axis < 2; axis++) {
        double *v = &s->x[rate_index(fx, axis)];
        double level = level_of(rig, fx, s, axis, *v, *v);
        if (level <= 0.0 || s->held[axis])
            continue;
        double drop = dt * level / inertia_of(rig, fx, s, axis);
        if (bearing->law[axis] == ROUNDED)
            *v = rounded_drop(*v, drop, bearing->width[axis]);
        else if (bearing->law[axis] == PRESLIDING)
            *v = dahl(s, axis, *v, drop, bearing->width[axis], dt);
        else
            *v = sliding(*v, drop);
    }
}
