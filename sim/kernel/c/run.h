/* The sampled loop: measure, command, hold the input, advance the plant. One run, or LANES runs side by side. */
#ifndef RUN_H
#define RUN_H

#include "events.h"
#include "law.h"
#include "noise.h"
#include "request.h"
#include "step.h"

typedef struct {
    const run_request *request;
    int64_t run[LANES]; /* the run that each lane computes; spare lanes repeat the last one */
    num c[N_CONSTANTS];
    plant_body body;
    law_state law;
} lane_group;

static num gather(const lane_group *group, const double *values, int64_t stride, int64_t offset)
{
    num result = NUM(0.0);
    for (int lane = 0; lane < LANES; lane++)
        lane_set(&result, lane, values[group->run[lane] * stride + offset]);
    return result;
}

static inline void scatter(const lane_group *group, double *values, int64_t sample, const num *row, int width)
{
    if (!values)
        return;
    for (int lane = 0; lane < LANES; lane++) {
        double *const to = values + (group->run[lane] * group->request->samples + sample) * width;
        for (int i = 0; i < width; i++)
            to[i] = lane_get(row[i], lane);
    }
}

/* A step that was computed as if there were no event in it. */
typedef struct {
    num x[N_STATES];
    step_stages seen;
} smooth_step;

/* Steps of one lane with an event in them are computed alone, by the same code for single and batched runs; without a step it settles. */
static inline void one_lane_events(lane_group *group, int lane, num t_s, num h_s, const num *u, const smooth_step *step)
{
    double x[N_STATES], sign[AXES], move[AXES], input[N_INPUTS], c[N_CONSTANTS], known[N_STATES + SEEN_NUMBERS];
    plant_body *const body = &group->body;
    for (int i = 0; i < N_STATES; i++)
        x[i] = lane_get(body->x[i], lane);
    for (int a = 0; a < AXES; a++) {
        sign[a] = lane_get(body->sign[a], lane);
        move[a] = lane_get(body->move[a], lane);
    }
    for (int j = 0; j < N_INPUTS; j++)
        input[j] = lane_get(u[j], lane);
    for (int i = 0; i < N_CONSTANTS; i++)
        c[i] = lane_get(group->c[i], lane);
    if (step) {
        const num *const seen = &step->seen.torque[0][0];
        for (int i = 0; i < N_STATES; i++)
            known[i] = lane_get(step->x[i], lane);
        for (int i = 0; i < SEEN_NUMBERS; i++)
            known[N_STATES + i] = lane_get(seen[i], lane);
        events_advance(x, sign, move, lane_get(t_s, lane), lane_get(h_s, lane), input, c, known, 0);
    } else {
        events_settle(x, sign, move, lane_get(t_s, lane), input, c);
    }
    for (int i = 0; i < N_STATES; i++)
        lane_set(&body->x[i], lane, x[i]);
    for (int a = 0; a < AXES; a++) {
        lane_set(&body->sign[a], lane, sign[a]);
        lane_set(&body->move[a], lane, move[a]);
    }
}

ALWAYS_INLINE void advance(lane_group *group, num t_s, num h_s, const num *u)
{
    smooth_step step;
    num *const x = step.x;
    rk4_step(t_s, h_s, &group->body, u, group->c, x, &step.seen);
    const mask suspect = step_suspect(&group->body, x, h_s, group->c, &step.seen);
    if (N_AXES + N_KINKS > 0 && __builtin_expect(any(suspect), 0)) {
        for (int lane = 0; lane < LANES; lane++)
            if (lane_is(suspect, lane)) {
                one_lane_events(group, lane, t_s, h_s, u, &step);
                for (int i = 0; i < N_STATES; i++)
                    lane_set(&x[i], lane, lane_get(group->body.x[i], lane));
            }
    }
    for (int i = 0; i < N_STATES; i++)
        group->body.x[i] = x[i];
}

static inline void start(lane_group *group, const run_request *request, int64_t first)
{
    group->request = request;
    for (int lane = 0; lane < LANES; lane++)
        group->run[lane] = first + lane < request->runs ? first + lane : request->runs - 1;
    num p[N_PARAMETERS];
    for (int i = 0; i < N_PARAMETERS; i++)
        p[i] = gather(group, request->p, N_PARAMETERS, i);
    model_constants(p, group->c);
    for (int i = 0; i < N_STATES; i++)
        group->body.x[i] = gather(group, request->x0, N_STATES, i);
    for (int a = 0; a < N_AXES; a++)
        if (request->locked && request->locked[a]) { /* stops on both sides of where it stands */
            group->c[AXIS_LOWER[a]] = group->c[AXIS_UPPER[a]] = group->body.x[AXIS_POSITION[a]];
            group->body.x[AXIS_VELOCITY[a]] = NUM(0.0);
        }
    for (int a = 0; a < AXES; a++)
        group->body.sign[a] = group->body.move[a] = NUM(0.0);
}

/* An encoder's reading: the nearest multiple of its step; 0 stands for none. */
static inline num quantised(num value, double step)
{
    return step > 0.0 ? lane_round(value / NUM(step)) * NUM(step) : value;
}

static inline void measure(const lane_group *group, int64_t sample, num t_s, num *y)
{
    const run_request *const request = group->request;
    model_outputs(t_s, group->body.x, group->c, y);
    for (int i = 0; i < N_OUTPUTS; i++) {
        if (request->measurement_sd && request->measurement_sd[i] > 0.0)
            for (int lane = 0; lane < LANES; lane++) {
                const double normal = noise_normal(request->seed, (uint64_t)group->run[lane], (uint64_t)sample, (uint64_t)i);
                lane_set(&y[i], lane, lane_get(y[i], lane) + request->measurement_sd[i] * normal);
            }
        y[i] = quantised(y[i], request->resolution[i]);
    }
}

static inline void command(lane_group *group, int64_t sample, const num *y, num *u)
{
    const run_request *const request = group->request;
    if (request->input) {
        const int64_t stride = request->input_per_run ? request->samples * N_INPUTS : 0;
        for (int j = 0; j < N_INPUTS; j++)
            u[j] = gather(group, request->input, stride, sample * N_INPUTS + j);
        return;
    }
    const double *const reference = request->reference + sample * N_OUTPUTS;
#if LANES == 1
    if (request->controller) {
        request->controller(request->context, reference, y, u);
        return;
    }
#endif
#if N_OUTPUTS == 2 && N_INPUTS == 2
    num wanted[2] = {NUM(reference[0]), NUM(reference[1])};
    if (sample == 0)
        law_reset(&group->law, request->law, y);
    law_step(&group->law, request->law, wanted, y, u);
#endif
}

/* Whether a state may be disturbed: not those of a held axis. */
static inline bool disturbed(const plant_body *body, int state, int lane)
{
    for (int a = 0; a < N_AXES; a++)
        if ((state == AXIS_POSITION[a] || state == AXIS_VELOCITY[a]) && lane_get(body->move[a], lane) == 0.0)
            return false;
    return true;
}

/* Random walk of the states over h_s. */
static inline void disturb(lane_group *group, int64_t sample, double h_s)
{
    const run_request *const request = group->request;
    for (int i = 0; request->process_sd && i < N_STATES; i++)
        for (int lane = 0; request->process_sd[i] > 0.0 && lane < LANES; lane++) {
            if (!disturbed(&group->body, i, lane))
                continue;
            const uint64_t channel = (uint64_t)(N_OUTPUTS + i);
            const double normal = noise_normal(request->seed, (uint64_t)group->run[lane], (uint64_t)sample, channel);
            lane_set(&group->body.x[i], lane, lane_get(group->body.x[i], lane) + request->process_sd[i] * sqrt(h_s) * normal);
        }
}

static inline void hold(lane_group *group, double t_s, double until_s, const num *u)
{
    const int32_t substeps = group->request->substeps;
    const double h_s = (until_s - t_s) / substeps;
    for (int32_t step = 0; step < substeps; step++)
        advance(group, NUM(t_s + step * h_s), NUM(h_s), u);
}

static void run_group(const run_request *request, int64_t first)
{
    lane_group group;
    num u[N_INPUTS], applied[N_INPUTS], y[N_OUTPUTS];
    start(&group, request, first);
    for (int64_t sample = 0; sample < request->samples; sample++) {
        const double t_s = request->t_s[sample];
        scatter(&group, request->x, sample, group.body.x, N_STATES);
        measure(&group, sample, NUM(t_s), y);
        scatter(&group, request->y, sample, y, N_OUTPUTS);
        command(&group, sample, y, u);
        scatter(&group, request->u, sample, u, N_INPUTS);
        for (int j = 0; j < N_INPUTS; j++)
            applied[j] = lane_clamp(u[j], group.c[INPUT_LOWER[j]], group.c[INPUT_UPPER[j]]);
        if (sample == 0)
            for (int lane = 0; lane < LANES; lane++)
                one_lane_events(&group, lane, NUM(t_s), NUM(0.0), applied, 0);
        if (sample + 1 < request->samples) {
            hold(&group, t_s, request->t_s[sample + 1], applied);
            disturb(&group, sample, request->t_s[sample + 1] - t_s);
        }
    }
}

#endif
