/* What the filter is asked and what it gives. */
#ifndef FILTER_H
#define FILTER_H

#include <stdint.h>

enum { MAX_COLUMNS = 256, MAX_NOISES = 64 };

/* A filter input of `steps` instants: the inputs held from each to the next, and at some of them a measurement, NaN where there is none.
 *
 * Whitened innovations w and their slopes dw go to the row of the instant, the outputs to their slots. A measurement whose place or slot
 * is below 0 moves the state, but nothing is kept of it and it does not count in the likelihood. Where all begins anew again and again,
 * each stretch ends before the next begins, the times of both may overlap, and one that fails is left as far as it came. */
typedef struct {
    int64_t steps;
    int32_t columns, slots, noises;
    const double *t_s, *u, *y, *r;           /* [steps], [steps][N_INPUTS], [steps][N_OUTPUTS] measured, their variances */
    const int64_t *row, *place;              /* [steps]: where the states go, [steps][N_OUTPUTS]: where the results go; or -1 */
    const double *p, *x0, *p0, *q;           /* [N_PARAMETERS]; [N_STATES]: start, its variance, noise intensity */
    const int64_t *anew;                     /* [steps]: the row of x0 from which all begins anew there, or -1; NULL: at the first only */
    const double *further;                   /* [steps][N_STATES] further variance over each step, or NULL */
    const double *added;                     /* [steps][N_STATES] what is added to each state over each step, or NULL */
    const double *forget;                    /* [N_STATES]: the rate, in 1/s, at which a state that is noise alone decays; 0 for others */
    const double *rub;                       /* [AXES]: how long, in s, the friction of an axis about its rest is in doubt */
    const double *q_by, *p0_by, *forget_by;  /* [noises][N_STATES] slopes of those by numbers of the noise, */
    const double *rub_by;                    /* [noises][AXES] */
    const uint8_t *locked;                   /* [AXES] */
    const int32_t *column, *slot;            /* [columns] parameters to differentiate by; [N_OUTPUTS] */
    double *w, *s, *dw, *x;                  /* [rows][slots] twice, [rows][slots][columns] or NULL, [rows][N_STATES] predicted */
    double *filtered;                        /* [rows][N_STATES] with the row's own measurement, or NULL */
    double *gram, *pull;                     /* [columns][columns] dw'dw and [columns] dw'w over all measurements */
    double *score, *information;             /* [noises], [noises][noises]: slopes of the likelihood by those, Fisher's information */
    double *F, *K, *H;                       /* [steps][N_STATES^2], [steps][N_OUTPUTS][N_STATES] twice, or NULL */
    double stated_rad_s;                     /* of the fastest motion of the plant as its file states it */
    double rest_s;                           /* the usual step from row to row */
    double log_likelihood;
} filter_request;

/* The filter's linear answer to small disturbances, `columns` of them side by side: added to a state over the step from an instant
 * (target < N_STATES) or to an output at an instant (target - N_STATES), as the gains F, K, H of a run say. It is answered in parts, the
 * instants from `first` up to `end`: `state` and `awake`, 0 at the start, carry the answer from one to the next. */
typedef struct {
    int64_t first, end;
    int32_t columns, targets;
    int32_t awake;                  /* columns disturbed so far */
    double *state;                  /* [N_STATES][MAX_COLUMNS] */
    const double *F, *K, *H;        /* as above */
    const double *s;                /* the variances of the whitened innovations, one after another */
    const double *value;            /* [end - first][targets][columns] */
    const int32_t *target;          /* [targets] */
    const int64_t *place;           /* [instants][N_OUTPUTS] the whitened innovation of each reading, or -1, */
    int64_t base;                   /* and the first of this part */
    double *dw;                     /* [from base on][columns] */
} response_request;

/* The same backwards: what a unit added to each state over each step adds to the sum of products of all answers with `w`. */
typedef struct {
    int64_t steps;
    const double *F, *K, *H, *s, *w; /* as above; w in the order of s */
    const int64_t *place;            /* [steps][N_OUTPUTS] */
    double *pull;                    /* [steps][N_STATES] */
} adjoint_request;

int32_t filter_run(filter_request *request);
int32_t filter_respond(response_request *request);
void filter_adjoint(adjoint_request *request);

#endif
