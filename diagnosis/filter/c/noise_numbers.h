/* What a run keeps of the slopes of the likelihood by numbers of the noise, all numbers side by side. */
#ifndef NOISE_NUMBERS_H
#define NOISE_NUMBERS_H

#include "states.h"

/* By blocks of numbers, those beyond the request's 0. Of the noise: intensity and forgetting of each state, doubt of each friction; then
 * what a substep brings each state, and what it keeps of it, and what it brings speeds after all else. */
typedef struct {
    block q[N], forget[N], rub[AXES], noise[N], kept[N], brought[AXES];
    block P[N][N], x[N], FP[N][N]; /* of the estimate; F dP, worked with within a step */
    block spread, nu, score;       /* of an innovation: ln s, nu / sqrt(s); of the likelihood */
    block information[MAX_NOISES];
} noise_slopes_block;

/* The blocks in use; and of each state that is awake the `count` that move it, where its row of F may be other than 0. */
typedef struct {
    noise_slopes_block by[MAX_NOISES / BLOCK];
    int blocks, count[N], mover[N][N];
} noise_slopes;

static block numbers_of(const filter_request *r, const double *by, int width, int first, int place)
{
    block found = {0.0};
    for (int k = 0; k < BLOCK && first + k < r->noises; k++)
        found[k] = by[(first + k) * width + place];
    return found;
}

static void start_noise_slopes(noise_slopes *to, const filter_request *r, const awake_states *states)
{
    to->blocks = (r->noises + BLOCK - 1) / BLOCK;
    for (int n = 0; n < states->awake; n++) {
        const int i = states->order[n];
        to->count[i] = 0;
        for (int m = 0; m < states->awake; m++)
            if (F_HAS[i][states->order[m]])
                to->mover[i][to->count[i]++] = states->order[m];
    }
    for (int b = 0; b < to->blocks; b++) {
        noise_slopes_block *const d = &to->by[b];
        *d = (noise_slopes_block){{{0.0}}};
        for (int n = 0; n < states->awake; n++) {
            const int i = states->order[n];
            d->q[i] = numbers_of(r, r->q_by, N, b * BLOCK, i);
            d->forget[i] = numbers_of(r, r->forget_by, N, b * BLOCK, i);
            d->P[i][i] = numbers_of(r, r->p0_by, N, b * BLOCK, i);
        }
        for (int a = 0; a < N_AXES; a++)
            d->rub[a] = numbers_of(r, r->rub_by, AXES, b * BLOCK, a);
    }
}

static void finish_noise_slopes(const noise_slopes *at, const filter_request *r)
{
    for (int k = 0; k < r->noises; k++) {
        r->score[k] = at->by[k / BLOCK].score[k % BLOCK];
        for (int l = 0; l < r->noises; l++)
            r->information[k * r->noises + l] = at->by[l / BLOCK].information[k][l % BLOCK];
    }
}

#endif
