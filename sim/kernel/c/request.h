/* What a run is made of; arrays are row-major, the last index as named in the comment. NULL: absent. */
#ifndef REQUEST_H
#define REQUEST_H

#include <stdint.h>

typedef struct {
    int64_t samples, runs;
    int32_t substeps;        /* Runge-Kutta steps per sample */
    int32_t input_per_run;   /* 0: all runs share `input` */
    const double *t_s;       /* [samples], increasing */
    const double *p;         /* [runs][N_PARAMETERS] */
    const double *x0;        /* [runs][N_STATES] */
    const double *input;     /* [samples][N_INPUTS] or [runs][samples][N_INPUTS]; NULL where a controller makes it */
    const double *reference; /* [samples][N_OUTPUTS], for the controller */
    const double *resolution;     /* [N_OUTPUTS], 0: not quantised */
    const double *measurement_sd; /* [N_OUTPUTS], before quantisation; or NULL */
    const double *process_sd;     /* [N_STATES], per square root of a second; or NULL */
    uint64_t seed;
    const uint8_t *locked;        /* [N_AXES], 1: held mechanically at x0; or NULL */
    const void *law;              /* law_table of law.h; or NULL */
    void (*controller)(void *context, const double *reference, const double *measured, double *input); /* single runs; or NULL */
    void *context;
    double *u, *y, *x; /* [runs][samples][N_INPUTS / N_OUTPUTS / N_STATES]: commanded, measured, true; each may be NULL */
} run_request;

#endif
