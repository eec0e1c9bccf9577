/* Runs one after another, one at a time. */
#define LANES 1
#include "run.h"

#include "exports.h"

void run_single(const run_request *request)
{
    for (int64_t run = 0; run < request->runs; run++)
        run_group(request, run);
}

static void load_group(lane_group *group, const double *c, const double *x, const double *sign, const double *move)
{
    for (int i = 0; i < N_CONSTANTS; i++)
        group->c[i] = c[i];
    for (int i = 0; i < N_STATES; i++)
        group->body.x[i] = x[i];
    for (int a = 0; a < AXES; a++) {
        group->body.sign[a] = sign[a];
        group->body.move[a] = move[a];
    }
}

static void store_body(const plant_body *body, double *x, double *sign, double *move)
{
    for (int i = 0; i < N_STATES; i++)
        x[i] = body->x[i];
    for (int a = 0; a < AXES; a++) {
        sign[a] = body->sign[a];
        move[a] = body->move[a];
    }
}

/* For a controller that calls from outside: one stretch of time under constant input within its limits; state and modes in place. */
void advance_single(const double *c, const double *u, double t_s, double h_s, int32_t substeps, double *x, double *sign, double *move)
{
    const run_request request = {.substeps = substeps};
    lane_group group = {.request = &request};
    load_group(&group, c, x, sign, move);
    hold(&group, t_s, t_s + h_s, u);
    store_body(&group.body, x, sign, move);
}

/* The modes at the start. */
void settle_single(const double *c, const double *u, double t_s, double *x, double *sign, double *move)
{
    events_settle(x, sign, move, t_s, u, c);
}

void constants_single(const double *p, double *c)
{
    model_constants(p, c);
}

int32_t constants_count(void)
{
    return N_CONSTANTS;
}

void limit_single(const double *c, double *u)
{
    for (int j = 0; j < N_INPUTS; j++)
        u[j] = lane_clamp(u[j], c[INPUT_LOWER[j]], c[INPUT_UPPER[j]]);
}

/* Outputs rounded to the encoders' steps. */
void measure_single(const double *c, const double *resolution, double t_s, const double *x, double *y)
{
    model_outputs(t_s, x, c, y);
    for (int i = 0; i < N_OUTPUTS; i++)
        y[i] = quantised(y[i], resolution[i]);
}

int32_t law_state_size(void)
{
    return sizeof(law_state);
}

void law_start_single(const law_table *law, void *state, const double *y)
{
    law_reset(state, law, y);
}

void law_step_single(const law_table *law, void *state, const double *reference, const double *y, double *u)
{
    law_step(state, law, reference, y, u);
}
