/* Inputs behind a stage with memory, as their mean over each step or over what is known of each frame; what holds before the first step
   is the first command. */
#include <math.h>
#include <stdint.h>

/* Two lags in a row of tau_s in all, `second` of it the latter's, below 1/2. What is away from the command fades with either;
 * of a lag that is none (1e-300 s: a quotient by it is still a number) nothing is left after any time. */
void lag_means(int64_t steps, const double *h_s, const double *wanted, double tau_s, double second, double *mean)
{
    const double first_s = tau_s * (1.0 - second), second_s = fmax(tau_s * second, 1e-300), ratio = first_s / (first_s - second_s);
    double x = wanted[0], behind = wanted[0];
    for (int64_t k = 0; k < steps; k++) {
        const double away = x - wanted[k], first = ratio * away, further = behind - wanted[k] - first;
        const double stays = exp(-h_s[k] / first_s), kept = exp(-h_s[k] / second_s);
        mean[k] = wanted[k] + (first * first_s * (1.0 - stays) + further * second_s * (1.0 - kept)) / h_s[k];
        x = wanted[k] + away * stays;
        behind = wanted[k] + first * stays + further * kept;
    }
}

/* At most `rate` per second. */
void slew_means(int64_t steps, const double *h_s, const double *wanted, double rate, double *mean)
{
    double x = wanted[0];
    for (int64_t k = 0; k < steps; k++) {
        const double away = x - wanted[k], most = rate * h_s[k];
        const double after = fabs(away) <= most ? wanted[k] : x - copysign(most, away);
        mean[k] = fabs(away) <= most ? wanted[k] + 0.5 * away * fabs(away) / most : 0.5 * (x + after);
        x = after;
    }
}

/* A frame that is lost with the probability lost[k] leaves the command before it. */
void lossy_means(int64_t steps, const double *lost, const double *wanted, double *mean)
{
    double x = wanted[0];
    for (int64_t k = 0; k < steps; k++) {
        x = wanted[k] + lost[k] * (x - wanted[k]);
        mean[k] = x;
    }
}
