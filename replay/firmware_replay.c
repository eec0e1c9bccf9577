/*
 * firmware_replay.c - the generated law with its numbers as data and its decisions as switches, to be held against a log.
 *
 * Operations and their order are those of the generated law.c: with every switch at its first value and the numbers of a table,
 * outputs are the same bits. No part of the firmware. `number` is float, or double for a law in double precision.
 */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifndef NUMBER
#define NUMBER float
#endif
typedef NUMBER number;

#define ROOM 12

enum { SCHEDULE_MEASURED, SCHEDULE_LAST_MEASURED, SCHEDULE_FILTERED_REFERENCE, SCHEDULE_REFERENCE };
enum { WINDUP_OBSERVER, WINDUP_NONE, WINDUP_CLAMP, WINDUP_FREEZE };
enum { ROUND_NEAREST, ROUND_DOWN, ROUND_TO_ZERO, ROUND_HALF_EVEN };

enum { OVERFLOW_NONE, OVERFLOW_WRAPS, OVERFLOW_SATURATES };
enum { AT_SUM, AT_COMMAND };

/* Ascending coefficients; count 0 where the term is left out of the sum. */
typedef struct {
    int32_t count;
    number c[ROOM];
} polynomial;

typedef struct {
    polynomial q[4], p[4], a[3], u_ff;
    int32_t prefilter_poles;
    number prefilter_gain;
    number u_min_V, u_max_V, u_safe_V;
    number reference_min_rad, reference_max_rad;
} axis_law;

typedef struct {
    axis_law axis[2];
    number psi_min_rad, psi_max_rad, least_schedule_rad, plausible_V;
    int32_t schedule, windup, feedforward_of_raw_reference;
    int32_t overflow, overflow_at;
    number overflow_low_V[2], overflow_span_V[2];
} replay_law;

typedef struct {
    number reference_1_rad, reference_2_rad;
    number e_0_rad, e_1_rad, e_2_rad;
    number v_V;
    number s_V[4], w_V[3];
} axis_state;

typedef struct {
    axis_state axis[2];
    number angle_rad[2], reference_rad[2];
} replay_state;

/*
 * What lies between the law's output and the logged number: which of the two it is, a factor and an offset, limits, a grid (step 0: none)
 * and the range in which an integer wraps round (span 0: none).
 */
typedef struct {
    int32_t source[2];
    double gain[2], offset_V[2];
    double low_V[2], high_V[2], step_V[2];
    double wrap_low_V[2], wrap_span_V[2];
    int32_t rounding;
} replay_channel;

void replay_start(const replay_law *law, const number angles_rad[2], replay_state *state);
void replay_step(const replay_law *law, replay_state *state, const number input[4], number output[2]);
bool replay_channel_agrees(const replay_channel *channel, int32_t rows, const number (*outputs)[2],
                           const double (*logged_V)[2], const double (*slack_V)[2]);
int32_t replay_run(const replay_law *law, const replay_channel *channel, replay_state *state, int32_t from, int32_t to,
                   const number (*inputs)[4], const double (*logged_V)[2], const double (*slack_V)[2],
                   number (*outputs)[2]);

static number finite_or(number value, number last)
{
    if (isfinite(value)) {
        return value;
    }
    return isfinite(last) ? last : (number)0;
}

static number clamp(number value, number low, number high)
{
    if (value < low) {
        return low;
    }
    return (high < value) ? high : value;
}

static number saturate(number value, number low, number high, number safe)
{
    return isnan(value) ? safe : clamp(value, low, high);
}

static number magnitude(number value)
{
    return (value < 0) ? -value : value;
}

static number value_at(const polynomial *terms, number x)
{
    number value = terms->c[terms->count - 1];
    for (int32_t power = terms->count - 2; power >= 0; power--) {
        value = value * x + terms->c[power];
    }
    return value;
}

/* `last` + `step`; in float32, where the step is too small to move it, the next number towards `target`. */
static number advanced(number last, number step, number target)
{
    const number moved = last + step;
    if (sizeof(number) != sizeof(float) || memcmp(&moved, &last, sizeof moved) != 0 || last == target) {
        return moved;
    }
    return nextafterf((float)last, (float)target) + 0.0f; /* + 0: a zero that is reached from below is +0, as in the law */
}

static void prefilter(const axis_law *axis, axis_state *state, number reference_rad)
{
    const number low_rad = axis->reference_min_rad;
    const number high_rad = axis->reference_max_rad;
    const number target_rad = clamp(reference_rad, low_rad, high_rad);
    if (axis->prefilter_poles == 0) {
        state->reference_1_rad = target_rad;
        state->reference_2_rad = target_rad;
        return;
    }
    const number first_rad =
        advanced(state->reference_1_rad, axis->prefilter_gain * (target_rad - state->reference_1_rad), target_rad);
    state->reference_1_rad = saturate(first_rad, low_rad, high_rad, target_rad);
    if (axis->prefilter_poles == 1) {
        state->reference_2_rad = state->reference_1_rad;
        return;
    }
    const number second_rad =
        advanced(state->reference_2_rad, axis->prefilter_gain * (state->reference_1_rad - state->reference_2_rad),
                 state->reference_1_rad);
    state->reference_2_rad = saturate(second_rad, low_rad, high_rad, target_rad);
}

/* The sum starts with the first term that is there, as in the generated text: 0 + x would lose the sign of -0. */
static void add_term(number *sum, bool *is_empty, const polynomial *terms, number x, number factor, bool subtract)
{
    if (terms->count == 0) {
        return;
    }
    const number product = value_at(terms, x) * factor;
    if (*is_empty) {
        *sum = product;
    } else {
        *sum = subtract ? *sum - product : *sum + product;
    }
    *is_empty = false;
}

static number move(const axis_law *axis, const axis_state *state, const number e_rad[4], number schedule_rad)
{
    number sum = 0;
    bool is_empty = true;
    for (int32_t i = 0; i < 4; i++) {
        add_term(&sum, &is_empty, &axis->q[i], schedule_rad, e_rad[i], false);
    }
    for (int32_t i = 0; i < 4; i++) {
        add_term(&sum, &is_empty, &axis->p[i], schedule_rad, state->s_V[i], i == 0);
    }
    for (int32_t i = 0; i < 3; i++) {
        add_term(&sum, &is_empty, &axis->a[i], schedule_rad, state->w_V[i], i == 0);
    }
    return sum;
}

/* The value in an integer of the law's that is too narrow: it wraps round, or stays at its end. */
static number overflowed(const replay_law *law, int32_t i, number value_V)
{
    const number low_V = law->overflow_low_V[i], span_V = law->overflow_span_V[i];
    if (!(span_V > 0)) {
        return value_V;
    }
    if (law->overflow == OVERFLOW_SATURATES) {
        return clamp(value_V, low_V, low_V + span_V);
    }
    return value_V - span_V * (number)floor((double)((value_V - low_V) / span_V));
}

/* value and its differences up to `count` - 1, from the last value's */
static void remember(number *differences, int32_t count, number value)
{
    number next = value;
    for (int32_t order = 0; order < count; order++) {
        const number last = differences[order];
        differences[order] = next;
        next = next - last;
    }
}

static number drive(const replay_law *law, int32_t i, axis_state *state, const number e_rad[4], number v_V, number u_ff_V)
{
    const axis_law *axis = &law->axis[i];
    const number last_v_V = state->v_V;
    if (law->overflow != OVERFLOW_NONE && law->overflow_at == AT_SUM) {
        v_V = overflowed(law, i, v_V);
    }
    const bool is_plausible = magnitude(v_V) <= law->plausible_V;
    if (!is_plausible) {
        v_V = 0;
        memset(state->s_V, 0, sizeof state->s_V);
        memset(state->w_V, 0, sizeof state->w_V);
    }
    number u_V = v_V + u_ff_V;
    if (law->overflow != OVERFLOW_NONE && law->overflow_at == AT_COMMAND) {
        u_V = overflowed(law, i, u_V);
    }
    const number limited_V = saturate(u_V, axis->u_min_V, axis->u_max_V, axis->u_safe_V);
    if (law->windup == WINDUP_CLAMP) {
        v_V -= u_V - limited_V;
    } else if (law->windup == WINDUP_FREEZE && u_V != limited_V) {
        v_V = last_v_V;
    }
    const number w_V = (law->windup == WINDUP_OBSERVER) ? u_V - limited_V : (number)0;
    remember(state->w_V, 3, w_V);
    remember(state->s_V, 4, v_V - w_V);
    state->e_0_rad = e_rad[0];
    state->e_1_rad = is_plausible ? e_rad[1] : (number)0;
    state->e_2_rad = is_plausible ? e_rad[2] : (number)0;
    state->v_V = v_V;
    return limited_V;
}

static number scheduling_angle(const replay_law *law, const replay_state *state, number last_psi_rad)
{
    number psi_rad = state->angle_rad[0];
    if (law->schedule == SCHEDULE_LAST_MEASURED) {
        psi_rad = last_psi_rad;
    } else if (law->schedule == SCHEDULE_FILTERED_REFERENCE) {
        psi_rad = state->axis[0].reference_2_rad;
    } else if (law->schedule == SCHEDULE_REFERENCE) {
        psi_rad = state->reference_rad[0];
    }
    const number held_rad = clamp(psi_rad, law->psi_min_rad, law->psi_max_rad);
    return (magnitude(held_rad) < law->least_schedule_rad) ? (number)0 : held_rad;
}

void replay_step(const replay_law *law, replay_state *state, const number input[4], number output[2])
{
    const number last_psi_rad = state->angle_rad[0];
    for (int32_t i = 0; i < 2; i++) {
        state->reference_rad[i] = finite_or(input[i], state->reference_rad[i]);
        state->angle_rad[i] = finite_or(input[2 + i], state->angle_rad[i]);
        prefilter(&law->axis[i], &state->axis[i], state->reference_rad[i]);
    }
    const number schedule_rad = scheduling_angle(law, state, last_psi_rad);
    const axis_state *elevation = &state->axis[0];
    const number ahead_rad = law->feedforward_of_raw_reference ? state->reference_rad[0] : elevation->reference_2_rad;
    for (int32_t i = 0; i < 2; i++) {
        const axis_law *axis = &law->axis[i];
        axis_state *self = &state->axis[i];
        const number u_ff_V = (axis->u_ff.count == 0) ? (number)0 : value_at(&axis->u_ff, ahead_rad);
        number e_rad[4];
        e_rad[0] = self->reference_2_rad - state->angle_rad[i];
        e_rad[1] = e_rad[0] - self->e_0_rad;
        e_rad[2] = e_rad[1] - self->e_1_rad;
        e_rad[3] = e_rad[2] - self->e_2_rad;
        const number v_V = self->v_V + move(axis, self, e_rad, schedule_rad);
        output[i] = drive(law, i, self, e_rad, v_V, u_ff_V);
    }
}

void replay_start(const replay_law *law, const number angles_rad[2], replay_state *state)
{
    memset(state, 0, sizeof *state);
    for (int32_t i = 0; i < 2; i++) {
        const axis_law *axis = &law->axis[i];
        const number angle_rad = finite_or(angles_rad[i], (number)0);
        const number reference_rad = clamp(angle_rad, axis->reference_min_rad, axis->reference_max_rad);
        state->angle_rad[i] = angle_rad;
        state->reference_rad[i] = reference_rad;
        state->axis[i].reference_1_rad = reference_rad;
        state->axis[i].reference_2_rad = reference_rad;
        state->axis[i].e_0_rad = reference_rad - angle_rad;
    }
}

static double on_grid(double u_V, double step_V, int32_t rounding)
{
    const double steps = u_V / step_V;
    switch (rounding) {
    case ROUND_NEAREST:
        return round(steps) * step_V;
    case ROUND_DOWN:
        return floor(steps) * step_V;
    case ROUND_TO_ZERO:
        return trunc(steps) * step_V;
    default:
        return nearbyint(steps) * step_V; /* as lrintf does where nobody changed its mode */
    }
}

static double seen(const replay_channel *channel, int32_t i, const number output[2])
{
    double value_V = channel->gain[i] * (double)output[channel->source[i]] + channel->offset_V[i];
    value_V = (value_V < channel->low_V[i]) ? channel->low_V[i] : value_V;
    value_V = (channel->high_V[i] < value_V) ? channel->high_V[i] : value_V;
    value_V = (channel->step_V[i] > 0.0) ? on_grid(value_V, channel->step_V[i], channel->rounding) : value_V;
    const double span_V = channel->wrap_span_V[i];
    return (span_V > 0.0) ? value_V - span_V * floor((value_V - channel->wrap_low_V[i]) / span_V) : value_V;
}

/* A number that was calculated with behind the law was rounded once more there; one that was only passed on was not. */
static double rounding_V(const replay_channel *channel, int32_t i, const number output[2], double seen_V)
{
    const double own_V = (double)output[channel->source[i]];
    const bool is_passed_on = seen_V == own_V || channel->step_V[i] > 0.0;
    const bool is_calculated = channel->gain[i] != 1.0 || channel->offset_V[i] != 0.0 || channel->wrap_span_V[i] > 0.0;
    return (is_calculated && !is_passed_on) ? 0x1p-22 * (fabs(own_V * channel->gain[i]) + fabs(seen_V)) : 0.0;
}

/* True where the log agrees within the slack; a row whose logged number is NaN is not in the log, and agrees. */
static bool agrees(const replay_channel *channel, const number output[2], const double logged_V[2],
                   const double slack_V[2])
{
    for (int32_t i = 0; i < 2; i++) {
        const double seen_V = seen(channel, i, output);
        const double slack = slack_V[i] + rounding_V(channel, i, output, seen_V);
        if (!isnan(logged_V[i]) && !(fabs(seen_V - logged_V[i]) <= slack)) {
            return false;
        }
    }
    return true;
}

/* True where the log agrees within the slack with outputs that some other law gave. */
bool replay_channel_agrees(const replay_channel *channel, int32_t rows, const number (*outputs)[2],
                           const double (*logged_V)[2], const double (*slack_V)[2])
{
    for (int32_t row = 0; row < rows; row++) {
        if (!agrees(channel, outputs[row], logged_V[row], slack_V[row])) {
            return false;
        }
    }
    return true;
}

/*
 * Steps rows from..to-1 and returns the first that does not agree with the log, the state being that before it; `to` if all agree.
 * Without a log (NULL) nothing is compared. Outputs, where asked for, are written up to the returned row and in it.
 */
int32_t replay_run(const replay_law *law, const replay_channel *channel, replay_state *state, int32_t from, int32_t to,
                   const number (*inputs)[4], const double (*logged_V)[2], const double (*slack_V)[2],
                   number (*outputs)[2])
{
    for (int32_t row = from; row < to; row++) {
        const replay_state before = *state;
        number output[2];
        replay_step(law, state, inputs[row], output);
        if (outputs != NULL) {
            outputs[row][0] = output[0];
            outputs[row][1] = output[1];
        }
        if (logged_V != NULL && !agrees(channel, output, logged_V[row], slack_V[row])) {
            *state = before;
            return row;
        }
    }
    return to;
}
