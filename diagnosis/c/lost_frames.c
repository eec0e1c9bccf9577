/* Frame by frame, how much likelier a command was lost than not: see lost_frames.py. */
#include <math.h>
#include <stdint.h>

#include "lost_frames.h"

#define MAX_DRIVES 8
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

/* What the innovation `lag` rows after a frame's changes by, where the drives' inputs change by `input` over that frame. */
static double answer(const loss_request *r, int64_t row, int64_t lag, int64_t slot, const double *input)
{
    const double *const unit = r->answers + ((row * r->apart + lag) * r->slots + slot) * r->drives;
    double sum = 0.0;
    for (int64_t d = 0; d < r->drives; d++)
        sum += unit[d] * input[d];
    return sum;
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
            r->arrived[here] += r->taken[row * r->drives + d];
        }
}

void loss_ratios(const loss_request *r)
{
    suppose(r);
    for (int64_t sweep = 0; sweep <= r->sweeps; sweep++) {
        const double share = sweep || !r->fresh ? mean_share(r) : r->first_share;
        const double belief = (double)(sweep + 1) / (double)(r->sweeps + 1);
        for (int64_t row = 1; row < r->rows; row++)
            if (r->judged[row])
                judge(r, row, share, belief);
    }
}
