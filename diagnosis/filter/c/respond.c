/* The filter's linear answer to small disturbances, by the gains that a run left. */
#include <stdbool.h>

#define LANES 1
#include "sincos.h"

#include "model.h"

#include "filter.h"

#define N N_STATES

/* How many columns have been disturbed so far, at least `awake`; those after them are still 0. */
static int disturbed(const response_request *r, const double *value, int awake)
{
    for (int k = r->columns; k > awake; k--)
        for (int t = 0; t < r->targets; t++)
            if (value[t * r->columns + k - 1] != 0.0)
                return k;
    return awake;
}

/* One output's part of the answer: the disturbance's own innovation, taken up by the gain; none where nothing was read. */
static void respond_output(const response_request *r, int64_t step, int output, int awake, const double *added,
                           double e[N][MAX_COLUMNS])
{
    const double *const H = r->H + (step * N_OUTPUTS + output) * N, *const K = r->K + (step * N_OUTPUTS + output) * N;
    const int64_t place = r->place[step * N_OUTPUTS + output];
    double nu[MAX_COLUMNS];
    bool seen = false;
    for (int i = 0; i < N; i++)
        seen |= H[i] != 0.0;
    for (int k = 0; k < awake; k++)
        nu[k] = seen && added ? added[k] : 0.0;
    for (int i = 0; i < N; i++)
        if (H[i] != 0.0)
            for (int k = 0; k < awake; k++)
                nu[k] += H[i] * e[i][k];
    if (seen)
        for (int i = 0; i < N; i++)
            for (int k = 0; k < awake; k++)
                e[i][k] -= K[i] * nu[k];
    if (place < 0)
        return;
    const double scale = seen ? 1.0 / sqrt(r->s[place]) : 0.0;
    double *const dw = r->dw + (place - r->base) * r->columns;
    for (int k = 0; k < awake; k++)
        dw[k] = nu[k] * scale;
}

int32_t filter_respond(response_request *r)
{
    static _Thread_local double next[N][MAX_COLUMNS];
    double (*const e)[MAX_COLUMNS] = (double(*)[MAX_COLUMNS])r->state;
    if (r->columns > MAX_COLUMNS)
        return -1;
    for (int64_t step = r->first; step < r->end; step++) {
        const double *const value = r->value + (step - r->first) * r->targets * r->columns;
        const int awake = r->awake = disturbed(r, value, r->awake);
        for (int o = 0; o < N_OUTPUTS; o++) {
            const double *added = 0;
            for (int t = 0; t < r->targets; t++)
                if (r->target[t] == N + o)
                    added = value + t * r->columns;
            respond_output(r, step, o, awake, added, e);
        }
        const double *const F = r->F + step * N * N;
        for (int i = 0; i < N; i++) {
            for (int k = 0; k < awake; k++)
                next[i][k] = 0.0;
            for (int m = 0; m < N; m++)
                if (F[i * N + m] != 0.0)
                    for (int k = 0; k < awake; k++)
                        next[i][k] += F[i * N + m] * e[m][k];
        }
        for (int t = 0; t < r->targets; t++)
            if (r->target[t] < N)
                for (int k = 0; k < awake; k++)
                    next[r->target[t]][k] += value[t * r->columns + k];
        for (int i = 0; i < N; i++)
            for (int k = 0; k < awake; k++)
                e[i][k] = next[i][k];
    }
    return 0;
}

/* The adjoint of respond_output: `e` holds what a unit of each state adds from behind the output on, then from before it on. */
static void pull_output(const adjoint_request *r, int64_t step, int output, double *e)
{
    const double *const H = r->H + (step * N_OUTPUTS + output) * N, *const K = r->K + (step * N_OUTPUTS + output) * N;
    const int64_t place = r->place[step * N_OUTPUTS + output];
    bool seen = false;
    for (int i = 0; i < N; i++)
        seen |= H[i] != 0.0;
    if (!seen)
        return;
    double nu = place < 0 ? 0.0 : r->w[place] / sqrt(r->s[place]);
    for (int i = 0; i < N; i++)
        nu -= K[i] * e[i];
    for (int i = 0; i < N; i++)
        if (H[i] != 0.0)
            e[i] += H[i] * nu;
}

void filter_adjoint(adjoint_request *r)
{
    double e[N] = {0.0};
    for (int64_t step = r->steps - 1; step >= 0; step--) {
        double *const pull = r->pull + step * N;
        const double *const F = r->F + step * N * N;
        for (int i = 0; i < N; i++) {
            pull[i] = e[i];
            e[i] = 0.0;
        }
        for (int m = 0; m < N; m++)
            for (int i = 0; i < N; i++)
                e[i] += F[m * N + i] * pull[m];
        for (int o = N_OUTPUTS - 1; o >= 0; o--)
            pull_output(r, step, o, e);
    }
}
