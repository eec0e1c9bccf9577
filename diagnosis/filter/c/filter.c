/* Extended Kalman filter over a plant's equations.
 *
 * The mean goes the kernel's way, with located friction and stops; the covariance, and the slopes by parameters of slopes.h, go by the
 * Jacobians at the middle of each step, second order in its length, of which fast states get pieces.
 */
#define LANES 1
#include "lane.h"

#include "quick_exp.h"
#define lane_exp quick_exp /* in the plant's equations below; where friction and stops act, events.c goes its own way */
#include "events.h"
#include "step.h"

#include "covariance.h"
#include "lag.h"
#include "measurement.h"
#include "process_noise.h"
#include "rest.h"
#include "substeps.h"

#define PIECES_ALLOWED 200 /* of the motion between events, */
#define PIECES_A_STEP 8    /* and for each step: a plant that rubs and rattles has some, one that makes no sense has no end of them */

/* One piece of a step, `share` of it, from t_s on. */
static void advance(filter_state *at, int64_t step, double t_s, double h_s, double share)
{
    filter_request *const r = at->request;
    double x[N], middle[N], noise[N], kept[N], level[AXES] = {0.0}, sign[AXES];
    bool rests[AXES], held[AXES];
    step_stages seen;
    plant_body before = at->body;
    for (int i = 0; i < N; i++)
        noise[i] = AWAKE(at->states, i) ? r->q[i] * h_s + (r->stir ? r->stir[step * N + i] * share : 0.0) : 0.0;
    forgetting(at, h_s, kept, noise);
    for (int a = 0; a < AXES; a++)
        sign[a] = 1.0;
    model_friction(t_s, at->body.x, at->u, at->c, sign, level);
    doubt(at, level, h_s, noise);
    rk4_step(t_s, h_s, &at->body, at->u, at->c, x, &seen);
    const bool suspect = N_AXES + N_KINKS > 0 && any(step_suspect(&at->body, x, h_s, at->c, &seen));
    if (suspect)
        at->pieces += events_advance(at->body.x, at->body.sign, at->body.move, t_s, h_s, at->u, at->c, NULL, NULL);
    else
        for (int i = 0; i < N; i++)
            at->body.x[i] = x[i];
    for (int i = 0; i < N; i++)
        if (kept[i] < 1.0)
            at->body.x[i] = kept[i] * before.x[i];
    for (int i = 0; i < N; i++)
        middle[i] = 0.5 * (before.x[i] + at->body.x[i]);
    resting(at, level, h_s, noise, rests);
    for (int a = 0; a < N_AXES; a++)
        held[a] = at->body.move[a] == 0.0;
    jacobians *const j = &at->j;
    model_state_slopes(t_s + 0.5 * h_s, middle, at->u, at->c, at->body.sign, j->A);
    follow(at, &before, t_s, h_s, j->A);
    for (int i = 0; i < N; i++)
        if (FOLLOWING(at->states, i))
            middle[i] = 0.5 * (before.x[i] + at->body.x[i]);
    if (r->columns)
        model_parameter_slopes(t_s + 0.5 * h_s, middle, at->u, at->c, at->body.sign, j->D);
    empty_rows(rests, j->A, N);
    transition(at, h_s);
    empty_rows(rests, at->F[0], WIDTH);
    for (int i = 0; i < N; i++)
        if (kept[i] < 1.0)
            at->F[i][i] = kept[i];
    follow_transition(at);
    /* The mean stays where friction holds it, however unsure its speed is: parameters move nothing there. */
    empty_rows(held, j->A, N);
    empty_rows(held, j->D, N_PARAMETERS);
    move_slopes(&at->slopes, r, &at->states, h_s, j->A, j->D, kept, at->following);
    for (int a = 0; a < N_AXES; a++) {
        if (held[a])
            hold_slopes(&at->slopes, r, AXIS_VELOCITY[a]);
        if (r->locked[a])
            noise[AXIS_VELOCITY[a]] = 0.0;
    }
    /* Friction stops within the usual step whatever moves an axis at rest: the row of its speed is emptied, and all that is unknown of that
     * comes after. That is what the usual step brings, however long this one was, and moves the other states by the root of time, as steps
     * that know nothing of one another do: so instants more or less change nothing. */
    const double usual = r->rest_s / h_s;
    double jolts[AXES] = {0.0}, stays[AXES] = {0.0};
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        if (rests[a])
            scale_column(at, v, sqrt(usual));
        (rests[a] ? stays : jolts)[a] = noise[v] * (rests[a] ? usual : 1.0);
        noise[v] = 0.0;
    }
    halve(at, kept, noise);
    spread(at, noise);
    for (int a = 0; a < N_AXES; a++) {
        const int v = AXIS_VELOCITY[a];
        at->P[v][v] += stays[a];
        if (rests[a])
            scale_column(at, v, 1.0 / sqrt(usual));
        if (jolts[a] > 0.0)
            stir(at, v, h_s, jolts[a]);
    }
}

static void advance_to_next(filter_state *at, int64_t step)
{
    const filter_request *const r = at->request;
    const double t_s = r->t_s[step], h_s = r->t_s[step + 1] - t_s;
    const int pieces = pieces_of(at, h_s);
    for (int piece = 0; piece < pieces; piece++) {
        advance(at, step, t_s + piece * h_s / pieces, h_s / pieces, 1.0 / pieces);
        if (r->F)
            keep_transition(at, r->F + step * N * N, piece == 0);
    }
}

/* Returns the number of instants done; fewer than asked when the state left all bounds, or rattles in nearly every step. */
int32_t filter_run(filter_request *request)
{
    static _Thread_local filter_state at;
    if (request->columns > MAX_COLUMNS)
        return -1;
    start(&at, request);
    for (int64_t step = 0; step < request->steps; step++) {
        apply(&at, step);
        measure(&at, step);
        events_settle(at.body.x, at.body.sign, at.body.move, request->t_s[step], at.u, at.c);
        if (step == 0) /* how fast the states are, before any step has told */
            model_state_slopes(request->t_s[0], at.body.x, at.u, at.c, at.body.sign, at.j.A);
        if (step + 1 < request->steps)
            advance_to_next(&at, step);
        for (int i = 0; i < N; i++)
            if (!(fabs(at.body.x[i]) < 1e9))
                return (int32_t)step;
        if (at.pieces > PIECES_ALLOWED + PIECES_A_STEP * step)
            return (int32_t)step;
    }
    finish_slopes(&at.slopes, request);
    return (int32_t)request->steps;
}
