/* Frame by frame, how much likelier a command was lost than not: see lost_frames.py. */
#include <math.h>

#include "lost_answer.h"

#define POLISH 2 /* sweeps after all were judged together */
static const double LEAST_SHARE = 0.003, MOST_SHARE = 0.8, FARTHEST = 200.0;

static double probability(double ratio, double share)
{
    const double odds = share * exp(fmax(-FARTHEST, fmin(ratio, FARTHEST)));
    return odds / (1.0 - share + odds);
}

static double mean_share(const loss_request *r)
{
    double sum = 0.0;
    for (int64_t row = 0; row < r->rows; row++)
        sum += r->lost[row];
    return fmax(LEAST_SHARE, fmin(sum / (double)r->rows, MOST_SHARE));
}

static void judge(const loss_request *r, int64_t row, double share, double belief)
{
    double held[MAX_DRIVES], *const taken = r->taken + row * r->drives;
    const int64_t lags = r->rows - row < r->apart ? r->rows - row : r->apart;
    int holds = 0;
    for (int64_t d = 0; d < r->drives; d++) {
        const int64_t input = r->column[d];
        held[d] = r->arrived[(row - 1) * r->inputs + input] - r->u[row * r->inputs + input];
        holds |= held[d] != 0.0;
    }
    double found = 0.0, power = 0.0;
    for (int64_t lag = 0; lag < lags; lag++)
        for (int64_t slot = 0; slot < r->slots; slot++) {
            const double a = answer(r, row, lag, slot, held);
            const double without = r->left[(row + lag) * r->slots + slot] + answer(r, row, lag, slot, taken);
            found += a * (without - 0.5 * a);
            power += a * a;
        }
    r->found[row] = holds ? found : 0.0;
    r->power[row] = power;
    if (!r->sweeps)
        return;
    const double lost = holds ? probability(belief * r->found[row], share) : share;
    double more[MAX_DRIVES];
    for (int64_t d = 0; d < r->drives; d++) {
        more[d] = lost * held[d] - taken[d];
        taken[d] = lost * held[d];
        r->arrived[row * r->inputs + r->column[d]] = r->u[row * r->inputs + r->column[d]] + taken[d];
    }
    r->lost[row] = lost;
    for (int64_t lag = 0; lag < lags; lag++)
        for (int64_t slot = 0; slot < r->slots; slot++)
            r->left[(row + lag) * r->slots + slot] -= answer(r, row, lag, slot, more);
}

/* What arrives where each frame is lost with the probability supposed before. */
static void suppose(const loss_request *r)
{
    for (int64_t row = 1; row < r->rows; row++)
        for (int64_t d = 0; d < r->drives; d++) {
            const int64_t here = row * r->inputs + r->column[d];
            r->taken[row * r->drives + d] = r->lost[row] * (r->arrived[here - r->inputs] - r->u[here]);
            r->arrived[here] = r->u[here] + r->taken[row * r->drives + d];
        }
}

/* The innovations with what is supposed taken out (sign 1), or back in (-1). */
static void explain(const loss_request *r, double sign)
{
    for (int64_t row = 1; row < r->rows; row++) {
        const int64_t lags = r->rows - row < r->apart ? r->rows - row : r->apart;
        for (int64_t lag = 0; lag < lags; lag++)
            for (int64_t slot = 0; slot < r->slots; slot++)
                r->left[(row + lag) * r->slots + slot] -= sign * answer(r, row, lag, slot, r->taken + row * r->drives);
    }
}

/* Every frame judged beside what is supposed of the others, again and again; believed at once, or more from sweep to sweep. */
static void judge_apart(const loss_request *r, int64_t sweeps, int at_once)
{
    for (int64_t sweep = 0; sweep <= sweeps; sweep++) {
        const double share = at_once || sweep || !r->fresh ? mean_share(r) : r->first_share;
        const double belief = at_once ? 1.0 : (double)(sweep + 1) / (double)(sweeps + 1);
        for (int64_t row = 1; row < r->rows; row++)
            if (r->judged[row])
                judge(r, row, share, belief);
    }
}

/* What is supposed of the frames, from scratch: all of them together. */
static void judge_together(const loss_request *r)
{
    const double share = r->fresh ? r->first_share : mean_share(r);
    explain(r, -1.0);
    likely_losses(r, share, r->lost);
    suppose(r);
    explain(r, 1.0);
}

/* A lower bound of the log evidence: what is left, less the spread about the mean of what may have arrived, less the information taken. */
static double bound(const loss_request *r)
{
    const double share = mean_share(r);
    double sum = 0.0;
    for (int64_t i = 0; i < r->rows * r->slots; i++)
        sum -= 0.5 * r->left[i] * r->left[i];
    for (int64_t row = 1; row < r->rows; row++) {
        const double q = r->lost[row];
        if (!r->judged[row])
            continue;
        sum -= 0.5 * r->power[row] * q * (1.0 - q);
        sum -= q > 0.0 ? q * log(q / share) : 0.0;
        sum -= q < 1.0 ? (1.0 - q) * log((1.0 - q) / (1.0 - share)) : 0.0;
    }
    return sum;
}

double loss_ratios(const loss_request *r)
{
    suppose(r);
    judge_apart(r, r->sweeps, 0);
    return bound(r);
}

double loss_ratios_together(const loss_request *r)
{
    suppose(r);
    judge_together(r);
    judge_apart(r, POLISH, 1);
    return bound(r);
}
