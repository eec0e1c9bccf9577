/* Which states a filter moves, and its numbers by blocks of them that stay in registers. */
#ifndef STATES_H
#define STATES_H

#include "step.h"

#include "filter.h"

#define N N_STATES
#define BLOCK 8 /* numbers worked on at a time that stand side by side: slopes by parameters, by noises */
#define PIECE 4 /* numbers of a row of a matrix: rows are short, and larger pieces would be filled up with zeros */

typedef double block __attribute__((vector_size(BLOCK * sizeof(double)), may_alias));
typedef double piece __attribute__((vector_size(PIECE * sizeof(double)), may_alias));
#define ROW ((N + PIECE - 1) / PIECE) /* pieces */
#define WIDTH (ROW * PIECE)
typedef double matrix[N][WIDTH] __attribute__((aligned(sizeof(piece)))); /* N by N, its rows filled up with zeros to whole pieces */

/* States of effects that are off sleep: nothing moves them, and what is known of them is 0. Those that follow others (follow.h) are no
 * noise, which forgets. */
typedef struct {
    bool sleeps[N], follows[N], empty[ROW];
    int order[N], awake; /* the states that do not sleep */
} awake_states;

/* What never sleeps the compiler knows. */
#define AWAKE(states, i) (STATE_SWITCH[i] < 0 || !(states).sleeps[i])
#define FOLLOWING(states, i) (FOLLOWS[i] && (states).follows[i])
#define FILLED(states, b) (!(states).empty[b])

static void wake(awake_states *states, const filter_request *request)
{
    states->awake = 0;
    for (int b = 0; b < ROW; b++)
        states->empty[b] = true;
    for (int i = 0; i < N; i++) {
        states->sleeps[i] = STATE_SWITCH[i] >= 0 && request->p[STATE_SWITCH[i] < 0 ? 0 : STATE_SWITCH[i]] == 0.0;
        states->follows[i] = FOLLOWS[i] && !states->sleeps[i] && request->forget[i] == 0.0;
        states->empty[i / PIECE] &= states->sleeps[i];
        if (!states->sleeps[i])
            states->order[states->awake++] = i;
    }
}

#endif
