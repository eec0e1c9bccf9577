/* Inputs behind a stage with memory, as their mean over each step or over what is known of each frame; what holds before the first step
   is the first command. */
#include <math.h>
#include <stdint.h>

/* First-order lag. */
void lag_means(int64_t steps, const double *h_s, const double *wanted, double tau_s, double *mean)
{
    double x = wanted[0];
    for (int64_t k = 0; k < steps; k++) {
        const double away = x - wanted[k], stays = exp(-h_s[k] / tau_s);
        mean[k] = wanted[k] + away * tau_s / h_s[k] * (1.0 - stays);
        x = wanted[k] + away * stays;
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
