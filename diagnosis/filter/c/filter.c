/* Extended Kalman filter over a plant's equations.
 *
 * The mean goes the kernel's way, with located friction and stops; the covariance, and the slopes by parameters of slopes.h, go by the
 * Jacobians at the middle of each substep (substep.h), second order in its length.
 */
#define LANES 1
#include "lane.h"

#include "quick_exp.h"
#define lane_exp quick_exp /* in the plant's equations below; where friction and stops act, events.c goes its own way */
#include "events.h"
#include "step.h"

#include "covariance.h"
#include "mean.h"
#include "measurement.h"
#include "noise_slopes.h"
#include "process_noise.h"
#include "rest.h"
#include "substep.h"

#define EVENTS_ALLOWED 200 /* that stick, slide or hit a stop, */
#define EVENTS_A_STEP 2    /* and for each step: plants that rub have 0.9 at most, one that makes no sense has no end of them */

/* Mean, slopes and covariance over a substep. */
static void predict(filter_state *at, substep *part)
{
    part->before = at->body;
    find_noise(at, part);
    find_memory(at, part);
    find_noise_slopes(at, part);
    doubt_friction(at, part);
    move_mean(at, part);
    find_rest(at, part);
    add_to_mean(at, part);
    differentiate(at, part);
    find_transition(at, part);
    carry_slopes(at, part);
    move_mean_slopes(at, part);
    predict_covariance(at, part);
}

static void advance_to_next(filter_state *at, int64_t step)
{
    const filter_request *const r = at->request;
    const double t_s = r->t_s[step], h_s = r->t_s[step + 1] - t_s;
    const int count = substeps_of(at, h_s);
    for (int k = 0; k < count; k++) {
        substep part = {.step = step, .t_s = t_s + k * h_s / count, .h_s = h_s / count, .share = 1.0 / count};
        predict(at, &part);
        if (r->F)
            keep_transition(at, r->F + step * N * N, k == 0);
    }
}

/* Whether a run, or a stretch of it, begins at a step. */
static bool begins(const filter_request *r, int64_t step) { return r->anew ? r->anew[step] >= 0 : step == 0; }

/* Whether the state left all bounds, or rattles in nearly every of `count` steps. */
static bool is_lost(const filter_state *at, int64_t count)
{
    bool lost = at->events > EVENTS_ALLOWED + EVENTS_A_STEP * count;
    for (int i = 0; i < N; i++)
        lost |= !(fabs(at->body.x[i]) < 1e9);
    return lost;
}

/* A stretch from `first` up to where the next begins, or to where the state is lost; returns the instant behind its last. */
static int64_t run_from(filter_state *at, filter_request *request, int64_t first)
{
    start(at, request, request->x0 + (request->anew ? request->anew[first] * N : 0));
    for (int64_t step = first;; step++) {
        hold_inputs(at, step);
        measure(at, step);
        events_settle(at->body.x, at->body.sign, at->body.move, request->t_s[step], at->u, at->c);
        if (step == first) /* how fast the states are, before any step has told */
            model_state_slopes(request->t_s[step], at->body.x, at->u, at->c, at->body.sign, at->j.A);
        const bool last = step + 1 == request->steps || begins(request, step + 1);
        if (!last)
            advance_to_next(at, step);
        if (last || is_lost(at, step - first))
            return step + 1;
    }
}

/* Returns the number of instants done; fewer than asked where the state was lost and nothing begins anew. */
int32_t filter_run(filter_request *request)
{
    static _Thread_local filter_state at;
    if (request->columns > MAX_COLUMNS)
        return -1;
    request->log_likelihood = 0.0;
    for (int64_t first = 0, next; first < request->steps; first = next) {
        next = run_from(&at, request, first);
        if (is_lost(&at, next - 1 - first) && !request->anew)
            return (int32_t)(next - 1);
        while (next < request->steps && !begins(request, next))
            next++;
    }
    finish_slopes(&at.slopes, request);
    finish_noise_slopes(&at.noises, request);
    return (int32_t)request->steps;
}
