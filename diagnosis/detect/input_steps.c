/* What rounding to steps does to commands, for many steps side by side, which a processor takes some at a time.
 *
 * Of a step q[k] the error is x = u / q[k] + shift[k] less its count: the nearest, held until x is more than 1/2 + hold[k] away from it
 * (sim/paths/path.py, in_held_steps). Errors count in steps; `count` is room for those of the last row. */
#include <math.h>
#include <stdint.h>

static inline double error_of(double u, double q, double hold, double shift, double *count)
{
    const double x = u / q + shift;
    *count = fabs(x - *count) > 0.5 + hold ? rint(x) : *count;
    return x - *count;
}

static void begin(double u, int64_t steps, const double *q, const double *shift, double *restrict count)
{
    for (int64_t k = 0; k < steps; k++)
        count[k] = rint(u / q[k] + shift[k]);
}

/* score[k] = -sum pull error, squares[k] = sum square error^2 over all rows. */
void step_sums(int64_t rows, const double *u, const double *pull, const double *square, int64_t steps, const double *q, const double *hold,
               const double *shift, double *restrict count, double *restrict score, double *restrict squares)
{
    begin(u[0], steps, q, shift, count);
    for (int64_t k = 0; k < steps; k++)
        score[k] = squares[k] = 0.0;
    for (int64_t row = 0; row < rows; row++)
        for (int64_t k = 0; k < steps; k++) {
            const double error = error_of(u[row], q[k], hold[k], shift[k], &count[k]);
            score[k] -= pull[row] * error;
            squares[k] += square[row] * error * error;
        }
}

/* error[row, k] */
void step_errors(int64_t rows, const double *u, int64_t steps, const double *q, const double *hold, const double *shift,
                 double *restrict count, double *restrict error)
{
    begin(u[0], steps, q, shift, count);
    for (int64_t row = 0; row < rows; row++)
        for (int64_t k = 0; k < steps; k++)
            error[row * steps + k] = error_of(u[row], q[k], hold[k], shift[k], &count[k]);
}
