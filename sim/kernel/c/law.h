/* The scheduled two-axis law in double precision, as records/table.py states it and design/law.py writes it out.
 *
 * Per axis, with e_0 = filtered reference - angle and e_1, e_2, e_3 its backward differences (s and w alike, of the last sample):
 *   v = v(k-1) - p_0 s_0 + p_1 s_1 + p_2 s_2 + p_3 s_3 + q_0 e_0 + q_1 e_1 + q_2 e_2 + q_3 e_3 - a_0 w_0 + a_1 w_1 + a_2 w_2
 *   u = v + u_ff(filtered elevation reference), limited;  w = u - limited u,  s = v - w
 * q and p are polynomials of the measured elevation within the scheduling range.
 */
#ifndef LAW_H
#define LAW_H

#include "lane.h"
#include "law_table.h"

typedef struct {
    num reference_rad, angle_rad, x1_rad, x2_rad, v_V, e[3], s[4], w[3];
} law_axis_state;

typedef struct {
    law_axis_state axis[2];
} law_state;

static inline num law_finite(num value, num otherwise)
{
    return select(is_less_equal(lane_abs(value), NUM(0x1.fffffffffffffp1023)), value, otherwise);
}

/* Put `value` in front of what is remembered and return its differences up to `count` - 1. */
static inline void law_differences(num value, const num *previous, num *differences, int count)
{
    differences[0] = value;
    for (int order = 1; order < count; order++)
        differences[order] = differences[order - 1] - previous[order - 1];
}

/* At rest at these angles: the filtered reference is the angle, or the end of the reference's range next to it. */
static inline void law_reset(law_state *self, const law_table *table, const num *angle_rad)
{
    for (int i = 0; i < 2; i++) {
        const law_axis *law = &table->axis[i];
        const num zero = NUM(0.0), angle = law_finite(angle_rad[i], zero);
        const num start = lane_clamp(angle, NUM(law->reference_min_rad), NUM(law->reference_max_rad));
        self->axis[i] = (law_axis_state){.reference_rad = start, .angle_rad = angle, .x1_rad = start, .x2_rad = start, .v_V = zero};
        for (int order = 0; order < 3; order++)
            self->axis[i].e[order] = self->axis[i].s[order] = self->axis[i].w[order] = zero;
        self->axis[i].s[3] = zero;
        self->axis[i].e[0] = start - angle;
    }
}

static inline void law_accept(law_axis_state *state, const law_axis *law, num reference_rad, num angle_rad)
{
    const num reference = law_finite(reference_rad, state->reference_rad);
    state->reference_rad = lane_clamp(reference, NUM(law->reference_min_rad), NUM(law->reference_max_rad));
    state->angle_rad = law_finite(angle_rad, state->angle_rad);
    const num gain = NUM(law->prefilter_gain);
    state->x1_rad = state->x1_rad + gain * (state->reference_rad - state->x1_rad);
    state->x2_rad = state->x2_rad + gain * (state->x1_rad - state->x2_rad);
}

static inline num law_control(law_axis_state *state, const law_axis *law, const num *k, num feedforward_V)
{
    num e[4], s[4], w[3];
    law_differences(state->x2_rad - state->angle_rad, state->e, e, 4);
    num v = state->v_V - k[LAW_P0] * state->s[0] + k[LAW_P1] * state->s[1] + k[LAW_P2] * state->s[2] + k[LAW_P3] * state->s[3];
    v = v + k[LAW_Q0] * e[0] + k[LAW_Q1] * e[1] + k[LAW_Q2] * e[2] + k[LAW_Q3] * e[3];
    v = v - NUM(law->a[0]) * state->w[0] + NUM(law->a[1]) * state->w[1] + NUM(law->a[2]) * state->w[2];
    const num u = v + feedforward_V;
    const num limited = select(is_equal(u, u), lane_clamp(u, NUM(law->u_min_V), NUM(law->u_max_V)), NUM(law->u_safe_V));
    const num excess = u - limited;
    law_differences(v - excess, state->s, s, 4);
    law_differences(excess, state->w, w, 3);
    state->v_V = v;
    for (int order = 0; order < 3; order++) {
        state->e[order] = e[order];
        state->s[order] = s[order];
        state->w[order] = w[order];
    }
    state->s[3] = s[3];
    return limited;
}

static inline void law_step(law_state *self, const law_table *table, const num *reference_rad, const num *angle_rad, num *u_V)
{
    for (int i = 0; i < 2; i++)
        law_accept(&self->axis[i], &table->axis[i], reference_rad[i], angle_rad[i]);
    const num psi = lane_clamp(self->axis[0].angle_rad, NUM(table->psi_min_rad), NUM(table->psi_max_rad));
    num k[2 * LAW_ROWS];
    for (int row = 0; row < 2 * LAW_ROWS; row++)
        k[row] = NUM(0.0);
    for (int power = table->coefficients - 1; power >= 0; power--)
        for (int row = 0; row < 2 * LAW_ROWS; row++)
            k[row] = k[row] * psi + NUM(table->scheduled[power][row]);
    for (int i = 0; i < 2; i++) {
        num feedforward_V = NUM(0.0);
        for (int power = table->feedforward_coefficients - 1; power >= 0; power--)
            feedforward_V = feedforward_V * self->axis[0].x2_rad + NUM(table->axis[i].feedforward_V[power]);
        u_V[i] = law_control(&self->axis[i], &table->axis[i], k + i * LAW_ROWS, feedforward_V);
    }
}

#endif
