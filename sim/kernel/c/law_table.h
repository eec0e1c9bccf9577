/* A controller table as law.h takes it; filled by sim/kernel/law.py. */
#ifndef LAW_TABLE_H
#define LAW_TABLE_H

#include <stdint.h>

enum { LAW_MAX_COEFFICIENTS = 12 };
enum { LAW_Q0, LAW_Q1, LAW_Q2, LAW_Q3, LAW_P0, LAW_P1, LAW_P2, LAW_P3, LAW_ROWS };

typedef struct {
    double a[3], prefilter_gain, u_min_V, u_max_V, u_safe_V, reference_min_rad, reference_max_rad;
    double feedforward_V[LAW_MAX_COEFFICIENTS];
} law_axis;

typedef struct {
    int32_t coefficients; /* per scheduled polynomial */
    int32_t feedforward_coefficients;
    double psi_min_rad, psi_max_rad;
    law_axis axis[2];
    double scheduled[LAW_MAX_COEFFICIENTS][2 * LAW_ROWS]; /* [power][axis * LAW_ROWS + row] */
} law_table;

#endif
