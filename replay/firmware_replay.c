/*
 * firmware_replay.c - the generated law with its numbers as data and its decisions as switches, to be held against a log.
 *
 * Operations and their order are those of the generated law.c: with every switch at its first value and the numbers of a table,
 * outputs are the same bits. No part of the firmware. `number` is float, or double for a law in double precision; LOOPS and ORDER are
 * the law's loops and the states of each.
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
#ifndef LOOPS
#define LOOPS 2
#endif
#ifndef ORDER
#define ORDER 3
#endif

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
    polynomial q[ORDER + 1], p[ORDER + 1], a[ORDER], u_ff;
    int32_t prefilter_poles;
    number prefilter_gain;
    number u_min_V, u_max_V, u_safe_V;
    number reference_min_rad, reference_max_rad;
} axis_law;

typedef struct {
    axis_law axis[LOOPS];
    int32_t scheduling; /* the loop by whose angle the coefficients go */
    number schedule_min_rad, schedule_max_rad, least_schedule_rad, plausible_V;
    int32_t schedule, windup, feedforward_of_raw_reference;
    int32_t overflow, overflow_at;
    number overflow_low_V[LOOPS], overflow_span_V[LOOPS];
} replay_law;

typedef struct {
    number reference_1_rad, reference_2_rad;
    number e_rad[ORDER]; /* by power of delta, as below */
    number v_V;
    number s_V[ORDER + 1], w_V[ORDER];
} axis_state;

typedef struct {
    axis_state axis[LOOPS];
    number angle_rad[LOOPS], reference_rad[LOOPS];
} replay_state;

/*
 * What lies between the law's output and the logged number: which of them it is, a factor and an offset, limits, a grid (step 0: none)
 * and the range in which an integer wraps round (span 0: none).
 */
typedef struct {
    int32_t source[LOOPS];
    double gain[LOOPS], offset_V[LOOPS];
    double low_V[LOOPS], high_V[LOOPS], step_V[LOOPS];
    double wrap_low_V[LOOPS], wrap_span_V[LOOPS];
    int32_t rounding;
} replay_channel;

void replay_start(const replay_law *law, const number angles_rad[LOOPS], replay_state *state);
void replay_step(const replay_law *law, replay_state *state, const number input[2 * LOOPS], number output[LOOPS]);
bool replay_channel_agrees(const replay_channel *channel, int32_t rows, const number (*outputs)[LOOPS],
                           const double (*logged_V)[LOOPS], const double (*slack_V)[LOOPS]);
int32_t replay_run(const replay_law *law, const replay_channel *channel, replay_state *state, int32_t from, int32_t to,
                   const number (*inputs)[2 * LOOPS], const double (*logged_V)[LOOPS], const double (*slack_V)[LOOPS],
                   number (*outputs)[LOOPS]);

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

static number move(const axis_law *axis, const axis_state *state, const number e_rad[ORDER + 1], number schedule_rad)
{
    number sum = 0;
    bool is_empty = true;
    for (int32_t i = 0; i <= ORDER; i++) {
        add_term(&sum, &is_empty, &axis->q[i], schedule_rad, e_rad[i], false);
    }
    for (int32_t i = 0; i <= ORDER; i++) {
        add_term(&sum, &is_empty, &axis->p[i], schedule_rad, state->s_V[i], i == 0);
    }
    for (int32_t i = 0; i < ORDER; i++) {
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

static number drive(const replay_law *law, int32_t i, axis_state *state, const number e_rad[ORDER + 1], number v_V, number u_ff_V)
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
    remember(state->w_V, ORDER, w_V);
    remember(state->s_V, ORDER + 1, v_V - w_V);
    for (int32_t i = 0; i < ORDER; i++) {
        state->e_rad[i] = (is_plausible || i == 0) ? e_rad[i] : (number)0;
    }
    state->v_V = v_V;
    return limited_V;
}

static number scheduling_angle(const replay_law *law, const replay_state *state, number last_rad)
{
    number angle_rad = state->angle_rad[law->scheduling];
    if (law->schedule == SCHEDULE_LAST_MEASURED) {
        angle_rad = last_rad;
    } else if (law->schedule == SCHEDULE_FILTERED_REFERENCE) {
        angle_rad = state->axis[law->scheduling].reference_2_rad;
    } else if (law->schedule == SCHEDULE_REFERENCE) {
        angle_rad = state->reference_rad[law->scheduling];
    }
    const number held_rad = clamp(angle_rad, law->schedule_min_rad, law->schedule_max_rad);
    return (magnitude(held_rad) < law->least_schedule_rad) ? (number)0 : held_rad;
}

void replay_step(const replay_law *law, replay_state *state, const number input[2 * LOOPS], number output[LOOPS])
{
    const number last_rad = state->angle_rad[law->scheduling];
    for (int32_t i = 0; i < LOOPS; i++) {
        state->reference_rad[i] = finite_or(input[i], state->reference_rad[i]);
        state->angle_rad[i] = finite_or(input[LOOPS + i], state->angle_rad[i]);
        prefilter(&law->axis[i], &state->axis[i], state->reference_rad[i]);
    }
    const number schedule_rad = scheduling_angle(law, state, last_rad);
    const number filtered_rad = state->axis[law->scheduling].reference_2_rad;
    const number ahead_rad = law->feedforward_of_raw_reference ? state->reference_rad[law->scheduling] : filtered_rad;
    for (int32_t i = 0; i < LOOPS; i++) {
        const axis_law *axis = &law->axis[i];
        axis_state *self = &state->axis[i];
        const number u_ff_V = (axis->u_ff.count == 0) ? (number)0 : value_at(&axis->u_ff, ahead_rad);
        number e_rad[ORDER + 1];
        e_rad[0] = self->reference_2_rad - state->angle_rad[i];
        for (int32_t power = 0; power < ORDER; power++) {
            e_rad[power + 1] = e_rad[power] - self->e_rad[power];
        }
        const number v_V = self->v_V + move(axis, self, e_rad, schedule_rad);
        output[i] = drive(law, i, self, e_rad, v_V, u_ff_V);
    }
}

void replay_start(const replay_law *law, const number angles_rad[LOOPS], replay_state *state)
{
    memset(state, 0, sizeof *state);
    for (int32_t i = 0; i < LOOPS; i++) {
        const axis_law *axis = &law->axis[i];
        const number angle_rad = finite_or(angles_rad[i], (number)0);
        const number reference_rad = clamp(angle_rad, axis->reference_min_rad, axis->reference_max_rad);
        state->angle_rad[i] = angle_rad;
        state->reference_rad[i] = reference_rad;
        state->axis[i].reference_1_rad = reference_rad;
        state->axis[i].reference_2_rad = reference_rad;
        state->axis[i].e_rad[0] = reference_rad - angle_rad;
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

static double seen(const replay_channel *channel, int32_t i, const number output[LOOPS])
{
    double value_V = channel->gain[i] * (double)output[channel->source[i]] + channel->offset_V[i];
    value_V = (value_V < channel->low_V[i]) ? channel->low_V[i] : value_V;
    value_V = (channel->high_V[i] < value_V) ? channel->high_V[i] : value_V;
    value_V = (channel->step_V[i] > 0.0) ? on_grid(value_V, channel->step_V[i], channel->rounding) : value_V;
    const double span_V = channel->wrap_span_V[i];
    return (span_V > 0.0) ? value_V - span_V * floor((value_V - channel->wrap_low_V[i]) / span_V) : value_V;
}

/* A number that was calculated with behind the law was rounded once more there; one that was only passed on was not. */
static double rounding_V(const replay_channel *channel, int32_t i, const number output[LOOPS], double seen_V)
{
    const double own_V = (double)output[channel->source[i]];
    const bool is_passed_on = seen_V == own_V || channel->step_V[i] > 0.0;
    const bool is_calculated = channel->gain[i] != 1.0 || channel->offset_V[i] != 0.0 || channel->wrap_span_V[i] > 0.0;
    return (is_calculated && !is_passed_on) ? 0x1p-22 * (fabs(own_V * channel->gain[i]) + fabs(seen_V)) : 0.0;
}

/* True where the log agrees within the slack; a row whose logged number is NaN is not in the log, and agrees. */
static bool agrees(const replay_channel *channel, const number output[LOOPS], const double logged_V[LOOPS],
                   const double slack_V[LOOPS])
{
    for (int32_t i = 0; i < LOOPS; i++) {
        const double seen_V = seen(channel, i, output);
        const double slack = slack_V[i] + rounding_V(channel, i, output, seen_V);
        if (!isnan(logged_V[i]) && !(fabs(seen_V - logged_V[i]) <= slack)) {
            return false;
        }
    }
    return true;
}

/* True where the log agrees within the slack with outputs that some other law gave. */
bool replay_channel_agrees(const replay_channel *channel, int32_t rows, const number (*outputs)[LOOPS],
                           const double (*logged_V)[LOOPS], const double (*slack_V)[LOOPS])
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
                   const number (*inputs)[2 * LOOPS], const double (*logged_V)[LOOPS], const double (*slack_V)[LOOPS],
                   number (*outputs)[LOOPS])
{
    for (int32_t row = from; row < to; row++) {
        const replay_state before = *state;
        number output[LOOPS];
        replay_step(law, state, inputs[row], output);
        if (outputs != NULL) {
            memcpy(outputs[row], output, sizeof output);
        }
        if (logged_V != NULL && !agrees(channel, output, logged_V[row], slack_V[row])) {
            *state = before;
            return row;
        }
    }
    return to;
}
