/* The measurement update: the readings of an instant, one after the other. */
#ifndef MEASUREMENT_H
#define MEASUREMENT_H

#include "estimate.h"
#include "noise_slopes.h"

/* The gain of a reading, for whoever asks what answers to it later (respond.c). */
static void keep_gain(const filter_request *r, int64_t reading, const double *K, const double *H)
{
    if (!r->K)
        return;
    for (int i = 0; i < N; i++) {
        r->K[reading * N + i] = K[i];
        r->H[reading * N + i] = H[i];
    }
}

/* The innovation nu of variance s into the likelihood and its place among the whitened ones; returns the place, or -1 where it has none. */
static int64_t keep_innovation(filter_request *r, int64_t reading, int output, double nu, double s)
{
    const int slot = r->slot[output];
    const int64_t row = r->place[reading], place = row >= 0 && slot >= 0 ? row * r->slots + slot : -1;
    if (place >= 0) {
        r->log_likelihood -= 0.5 * (nu * nu / s + log(s));
        r->w[place] = nu * (1.0 / sqrt(s));
        r->s[place] = s;
    }
    return place;
}

/* One scalar measurement: innovation, gain, new mean, covariance and slopes. */
static void correct(filter_state *at, int64_t step, int output, double predicted, const double *H)
{
    filter_request *const r = at->request;
    const int64_t reading = step * N_OUTPUTS + output;
    double PH[WIDTH] __attribute__((aligned(sizeof(piece)))) = {0.0}, s = r->r[reading];
    for (int n = 0; n < at->states.awake; n++)
        UNROLLED for (int b = 0; b < ROW; b++)
            if (H[at->states.order[n]] != 0.0 && FILLED(at->states, b))
                ((piece *)PH)[b] += ((piece *)at->P[at->states.order[n]])[b] * H[at->states.order[n]];
    for (int n = 0; n < at->states.awake; n++)
        s += H[at->states.order[n]] * PH[at->states.order[n]];
    const double nu = r->y[reading] - predicted;
    double K[N] = {0.0};
    for (int n = 0; n < at->states.awake; n++) {
        const int i = at->states.order[n];
        K[i] = PH[i] / s;
        at->body.x[i] += K[i] * nu;
        UNROLLED for (int b = 0; b < ROW; b++)
            if (FILLED(at->states, b))
                ((piece *)at->P[i])[b] -= K[i] * ((piece *)PH)[b];
    }
    keep_gain(r, reading, K, H);
    const filter_correction given = {H, K, nu, 1.0 / sqrt(s), keep_innovation(r, reading, output, nu, s)};
    correct_noise_slopes(at, given, PH, s);
    correct_slopes(&at->slopes, r, &at->states, output, at->j.E + output * N_PARAMETERS, given);
}

/* The readings of an instant; those of a row go out with its states, predicted and filtered. */
static void measure(filter_state *at, int64_t step)
{
    filter_request *const r = at->request;
    const int64_t row = r->row[step];
    double y[N_OUTPUTS];
    if (row >= 0)
        for (int i = 0; i < N; i++)
            r->x[row * N + i] = at->body.x[i];
    bool any_output = false;
    for (int o = 0; o < N_OUTPUTS; o++)
        any_output |= !isnan(r->y[step * N_OUTPUTS + o]);
    if (any_output) {
        model_output_slopes(r->t_s[step], at->body.x, at->c, at->j.H, at->j.E);
        for (int o = 0; o < N_OUTPUTS; o++) {
            if (isnan(r->y[step * N_OUTPUTS + o]))
                continue;
            model_outputs(r->t_s[step], at->body.x, at->c, y);
            correct(at, step, o, y[o], at->j.H + o * N);
        }
    }
    if (row >= 0 && r->filtered)
        for (int i = 0; i < N; i++)
            r->filtered[row * N + i] = at->body.x[i];
}

#endif
