/* What the innovation `lag` rows after a frame's changes by, where the drives' inputs change by `input` over that frame. */
#ifndef LOST_ANSWER_H
#define LOST_ANSWER_H

#include "lost_frames.h"

#define MAX_DRIVES 8

static inline double answer(const loss_request *r, int64_t row, int64_t lag, int64_t slot, const double *input)
{
    const double *const unit = r->answers + ((row * r->apart + lag) * r->slots + slot) * r->drives;
    double sum = 0.0;
    for (int64_t d = 0; d < r->drives; d++)
        sum += unit[d] * input[d];
    return sum;
}

#endif
