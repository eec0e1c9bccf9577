/* What Python calls. */
#ifndef EXPORTS_H
#define EXPORTS_H

#include <stdint.h>

#include "law_table.h"
#include "request.h"

/* The runs one after another, or side by side. */
void run_single(const run_request *request);
void run_batch(const run_request *request);

/* For a controller that calls from outside; arrays as in request.h, state and modes (sign, move) in place. */
int32_t constants_count(void); /* how many constants there are room for */
void constants_single(const double *p, double *c);
void limit_single(const double *c, double *u);
void settle_single(const double *c, const double *u, double t_s, double *x, double *sign, double *move);
void advance_single(const double *c, const double *u, double t_s, double h_s, int32_t substeps, double *x, double *sign, double *move);
void measure_single(const double *c, const double *resolution, double t_s, const double *x, double *y);

/* The law alone, for a loop that is closed outside; `state` has room for law_state_size() bytes. */
int32_t law_state_size(void);
void law_start_single(const law_table *law, void *state, const double *y);
void law_step_single(const law_table *law, void *state, const double *reference, const double *y, double *u);

#endif
