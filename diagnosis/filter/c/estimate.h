/* What is known of the plant at an instant, mean and covariance, with what a step works with; how a run begins. */
#ifndef ESTIMATE_H
#define ESTIMATE_H

#include "follow.h"
#include "noise_numbers.h"
#include "slopes.h"
#include "states.h"

/* Entries that are identically zero are never written, so these are emptied once a run. */
typedef struct {
    double A[N * N], D[N * N_PARAMETERS], H[N_OUTPUTS * N], E[N_OUTPUTS * N_PARAMETERS];
} jacobians;

typedef struct {
    filter_request *request;
    double c[N_CONSTANTS], u[N_INPUTS];
    plant_body body;
    int64_t events; /* of the motion so far */
    jacobians j;
    matrix P, A, square, F, FP, PF; /* the last five are worked with within a step */
    /* Rows and columns of matrices are 0 where a state sleeps, but F's are those of 1, and are left alone. */
    awake_states states;
    follow_state following[N];
    filter_slopes slopes;
    noise_slopes noises;
} filter_state;

/* Before the first reading: the start x0 asked for, as sure as asked for. */
static void start(filter_state *at, filter_request *request, const double *x0)
{
    at->request = request;
    at->j = (jacobians){{0.0}, {0.0}, {0.0}, {0.0}};
    model_constants(request->p, at->c);
    wake(&at->states, request);
    start_slopes(&at->slopes, request);
    start_noise_slopes(&at->noises, request, &at->states);
    for (int i = 0; i < N; i++) {
        at->following[i].z = -1.0;
        at->body.x[i] = x0[i];
        for (int j = 0; j < WIDTH; j++) {
            at->A[i][j] = at->square[i][j] = at->FP[i][j] = at->PF[i][j] = 0.0;
            at->F[i][j] = i == j;
            at->P[i][j] = i == j && !at->states.sleeps[i] ? request->p0[i] : 0.0;
        }
    }
    for (int a = 0; a < N_AXES; a++)
        if (request->locked[a]) {
            at->c[AXIS_LOWER[a]] = at->c[AXIS_UPPER[a]] = at->body.x[AXIS_POSITION[a]];
            at->body.x[AXIS_VELOCITY[a]] = 0.0;
        }
    for (int a = 0; a < AXES; a++)
        at->body.sign[a] = at->body.move[a] = 0.0;
    at->events = 0;
}

/* The inputs that are held from an instant on, within their limits. */
static void hold_inputs(filter_state *at, int64_t step)
{
    for (int j = 0; j < N_INPUTS; j++)
        at->u[j] = lane_clamp(at->request->u[step * N_INPUTS + j], at->c[INPUT_LOWER[j]], at->c[INPUT_UPPER[j]]);
}

#endif
