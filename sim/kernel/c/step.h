/* One Runge-Kutta step of fourth order with the axes' dry friction and stops held fixed, and the check whether they could be. */
#ifndef STEP_H
#define STEP_H

#include "lane.h"
#include "sincos.h"

#include "model.h"

#define AXES (N_AXES > 0 ? N_AXES : 1)

/* A plant in motion: its state and, for each axis, whether it moves (1) or is held (0) and which way its friction points. */
typedef struct {
    num x[N_STATES], sign[AXES], move[AXES];
} plant_body;

/* What the four stages of a step saw of each axis: torques and breakaway levels, and the accelerations at both ends. */
typedef struct {
    num torque[4][AXES], up[4][AXES], down[4][AXES], start[AXES], end[AXES];
} step_stages;
#define SEEN_NUMBERS ((int)(sizeof(step_stages) / sizeof(num)))

ALWAYS_INLINE void rk4_stage(num t_s, const plant_body *body, const num *x, const num *u, const num *c, int stage, num *dx,
                             step_stages *seen)
{
    model_rates(t_s, x, u, c, body->sign, body->move, dx, seen->torque[stage], seen->up[stage], seen->down[stage]);
}

/* x(t + h) from x(t); u is held. */
ALWAYS_INLINE void rk4_step(num t_s, num h_s, const plant_body *body, const num *u, const num *c, num *x, step_stages *seen)
{
    const num half = NUM(0.5) * h_s, sixth = h_s / NUM(6.0);
    num k1[N_STATES], k2[N_STATES], k3[N_STATES], k4[N_STATES], at[N_STATES];
    rk4_stage(t_s, body, body->x, u, c, 0, k1, seen);
    for (int i = 0; i < N_STATES; i++)
        at[i] = body->x[i] + half * k1[i];
    rk4_stage(t_s + half, body, at, u, c, 1, k2, seen);
    for (int i = 0; i < N_STATES; i++)
        at[i] = body->x[i] + half * k2[i];
    rk4_stage(t_s + half, body, at, u, c, 2, k3, seen);
    for (int i = 0; i < N_STATES; i++)
        at[i] = body->x[i] + h_s * k3[i];
    rk4_stage(t_s + h_s, body, at, u, c, 3, k4, seen);
    for (int i = 0; i < N_STATES; i++)
        x[i] = body->x[i] + sixth * ((k1[i] + NUM(2.0) * (k2[i] + k3[i])) + k4[i]);
    for (int a = 0; a < N_AXES; a++) {
        seen->start[a] = k1[AXIS_VELOCITY[a]];
        seen->end[a] = k4[AXIS_VELOCITY[a]];
    }
}

/* Lanes whose friction or stops may have acted within the step from `body` to x: these go the careful way of events.c.
 *
 * A moving axis: velocity at or through zero, or possibly there and back (both end tangents reach zero), or a stop passed.
 * A state through the kink of the rates at its zero.
 * A held axis: torque beyond breakaway in any stage; towards a stop that it lies against, it is held by any torque.
 */
ALWAYS_INLINE mask step_suspect(const plant_body *body, const num *x, num h_s, const num *c, const step_stages *seen)
{
    mask suspect = is_less(NUM(1.0), NUM(0.0));
    UNROLLED for (int a = 0; a < N_AXES; a++) {
        const num sign = body->sign[a], lower = c[AXIS_LOWER[a]], upper = c[AXIS_UPPER[a]];
        const num before = sign * body->x[AXIS_VELOCITY[a]], after = sign * x[AXIS_VELOCITY[a]];
        const num position = x[AXIS_POSITION[a]];
        const mask moving = is_less(NUM(0.0), body->move[a]);
        const mask rubbing = moving & is_less(NUM(0.0), lane_abs(sign));
        const mask dip = is_less(before + sign * seen->start[a] * h_s, NUM(0.0)) & is_less(after - sign * seen->end[a] * h_s, NUM(0.0));
        suspect |= rubbing & (is_less_equal(after, NUM(0.0)) | dip);
        suspect |= moving & (is_less(position, lower) | is_less(upper, position));
        const mask below = is_less_equal(position, lower), above = is_less_equal(upper, position);
        UNROLLED for (int stage = 0; stage < 4; stage++) {
            const mask broken = (is_less(seen->up[stage][a], seen->torque[stage][a]) & ~above) |
                                (is_less(seen->torque[stage][a], -seen->down[stage][a]) & ~below);
            suspect |= broken & ~moving;
        }
    }
    UNROLLED for (int k = 0; k < N_KINKS; k++)
        suspect |= is_less(body->x[KINK_STATE[k]] * x[KINK_STATE[k]], NUM(0.0));
    return suspect;
}

#endif
