/* A run with given inputs and the columns to differentiate by. */
#ifndef SENSITIVITY_H
#define SENSITIVITY_H

#include <stdint.h>

typedef struct {
    int64_t samples;
    int32_t substeps, columns;
    const double *t_s, *p, *x0, *input; /* [samples], [N_PARAMETERS], [N_STATES], [samples][N_INPUTS] */
    const int32_t *column; /* [columns]: a parameter's index, then on: input gains, input offsets, initial states */
    const double *lower_slope, *upper_slope; /* [N_AXES][N_PARAMETERS]: derivatives of the stops */
    double *y, *dy, *x; /* [samples][N_OUTPUTS], [samples][N_OUTPUTS][columns], [samples][N_STATES] or NULL */
} sensitivity_request;

int sensitivity_run(const sensitivity_request *request);

#endif
