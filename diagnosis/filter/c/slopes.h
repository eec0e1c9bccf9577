/* The slopes of a filter's whitened innovations by parameters of the plant: those of its state, S = dx/dp, go along with the mean, step by
 * step and measurement by measurement. They leave out how the gain itself moves. */
#ifndef SLOPES_H
#define SLOPES_H

#include "follow.h"
#include "states.h"

#define BLOCKS (MAX_COLUMNS / BLOCK)
#define PENDING 32 /* measurements whose slopes are multiplied at a time */
/* Blocks may alias whatever there is: `restrict` below says what they do not. */

/* By blocks of columns, those beyond the request's 0: slopes of the state; whitened slopes not yet multiplied, the lower half of their
 * products, and those with the innovations; what the plant's equations say of the columns, of outputs E and of rates D. */
typedef struct {
    block S[BLOCKS][N], waiting[BLOCKS][PENDING], gram[BLOCKS][MAX_COLUMNS], pull[BLOCKS];
    block E[N_OUTPUTS][BLOCKS], D[N][BLOCKS];
    int pending; /* measurements whose slopes wait */
} filter_slopes;

/* One scalar measurement as the filter took it: the slopes of its output by the states, its gain, innovation and 1 / its spread; the row
 * of dw where its slopes are kept, or -1. */
typedef struct {
    const double *H, *K;
    double nu, scale;
    int64_t place;
} filter_correction;

static int blocks(const filter_request *request) { return (request->columns + BLOCK - 1) / BLOCK; }

/* The request's columns of a row of slopes by all parameters. */
static void gather(const filter_request *request, const double *row, block *to)
{
    double *const entry = (double *)to;
    for (int k = 0; k < request->columns; k++)
        entry[k] = row[request->column[k]];
}

static void start_slopes(filter_slopes *at, const filter_request *r)
{
    at->pending = 0;
    for (int b = 0; b < blocks(r); b++) {
        for (int m = 0; m < PENDING; m++)
            at->waiting[b][m] = (block){0.0};
        for (int k = 0; k < MAX_COLUMNS; k++)
            at->gram[b][k] = (block){0.0};
        at->pull[b] = (block){0.0};
        for (int o = 0; o < N_OUTPUTS; o++)
            at->E[o][b] = (block){0.0};
        for (int i = 0; i < N; i++)
            at->S[b][i] = at->D[i][b] = (block){0.0};
    }
}

/* gram += W'W of the slopes that wait, four rows of it at a time. */
static void multiply(filter_slopes *at, const filter_request *r)
{
    for (int k = 0; k < r->columns; k += 4) {
        const double *const left = (const double *)at->waiting[k / BLOCK] + k % BLOCK;
        for (int b = 0; b <= k / BLOCK; b++) {
            block sum[4] = {{0.0}};
            for (int m = 0; m < at->pending; m++)
                UNROLLED for (int i = 0; i < 4; i++)
                    sum[i] += left[m * BLOCK + i] * at->waiting[b][m];
            UNROLLED for (int i = 0; i < 4; i++)
                at->gram[b][k + i] += sum[i];
        }
    }
    at->pending = 0;
}

/* The slopes of a measurement's innovation, and what its gain takes off those of the state; kept whitened where it has a place. `by` are
 * the output's own slopes by all parameters. */
static void correct_slopes(filter_slopes *at, const filter_request *r, const awake_states *restrict states, int output,
                           const double *by, filter_correction given)
{
    if (E_HAS[output])
        gather(r, by, at->E[output]);
    for (int b = 0; b < blocks(r); b++) {
        block slope = -at->E[output][b];
        for (int i = 0; i < N; i++)
            if (given.H[i] != 0.0)
                slope -= given.H[i] * at->S[b][i];
        for (int n = 0; n < states->awake; n++)
            at->S[b][states->order[n]] += given.K[states->order[n]] * slope;
        if (given.place < 0)
            continue;
        slope *= given.scale;
        at->waiting[b][at->pending] = slope;
        at->pull[b] += slope * (given.nu * given.scale);
        if (r->dw)
            for (int k = b * BLOCK; k < r->columns && k < (b + 1) * BLOCK; k++)
                r->dw[given.place * r->columns + k] = slope[k % BLOCK];
    }
    if (given.place >= 0 && ++at->pending == PENDING)
        multiply(at, r);
}

/* The slopes one step on: S + h (1 + h A / 2) (A S + D), those of noise with a memory by what is kept of it, those of states that follow by
 * their weights. `by` are the rates' own slopes by all parameters. */
static void move_slopes(filter_slopes *at, const filter_request *r, const awake_states *restrict states, double h_s,
                        const double *restrict A, const double *restrict by, const double *restrict kept,
                        const follow_state *restrict following)
{
    UNROLLED for (int i = 0; i < N; i++)
        if (D_HAS[i] && AWAKE(*states, i))
            gather(r, by + i * N_PARAMETERS, at->D[i]);
    for (int b = 0; b < blocks(r); b++) {
        block *const S = at->S[b], rates[N] = {{0.0}};
        UNROLLED for (int i = 0; i < N; i++) {
            if (!AWAKE(*states, i))
                continue;
            rates[i] = at->D[i][b];
            UNROLLED for (int m = 0; m < N; m++)
                if (A_HAS[i][m])
                    rates[i] += A[i * N + m] * S[m];
        }
        UNROLLED for (int i = 0; i < N; i++) {
            if (FOLLOWING(*states, i) || !AWAKE(*states, i))
                continue;
            block second = {0.0};
            UNROLLED for (int m = 0; m < N; m++)
                if (A_HAS[i][m])
                    second += A[i * N + m] * rates[m];
            S[i] = kept[i] < 1.0 ? kept[i] * S[i] : S[i] + h_s * (rates[i] + 0.5 * h_s * second);
        }
        UNROLLED for (int i = 0; i < N; i++) {
            if (!FOLLOWING(*states, i))
                continue;
            const follow_weights w = following[i].whole;
            block last = at->D[i][b];
            UNROLLED for (int m = 0; m < N; m++)
                if (m != i && A_HAS[i][m])
                    last += A[i * N + m] * S[m];
            S[i] = w.kept * S[i] + w.first * (rates[i] - A[i * N + i] * S[i]) + w.last * last;
        }
    }
}

/* A state that is held: parameters move it no longer. */
static void hold_slopes(filter_slopes *at, const filter_request *r, int state)
{
    for (int b = 0; b < blocks(r); b++)
        at->S[b][state] = (block){0.0};
}

/* The products of all slopes, with one another and with the innovations, into the request. */
static void finish_slopes(filter_slopes *at, const filter_request *r)
{
    multiply(at, r);
    for (int k = 0; k < r->columns; k++) {
        r->pull[k] = at->pull[k / BLOCK][k % BLOCK];
        for (int l = 0; l <= k; l++)
            r->gram[k * r->columns + l] = r->gram[l * r->columns + k] = at->gram[l / BLOCK][k][l % BLOCK];
    }
}

#endif
