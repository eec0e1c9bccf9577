/* Frames of one flight: inputs u (rows, inputs), of which `column` drive something; answers (rows, apart, slots, drives) of the whitened
 * innovations to a unit of each drive's input over each frame; `left` (rows, slots) the innovations, found with losses `lost` (rows)
 * supposed before; `arrived` (rows, inputs), at first u, and `taken` (rows, drives), at first 0, what losses make of the inputs; `found`
 * (rows) the log ratios, `power` (rows) the squared answers to each loss. `sweeps` 0 takes every frame for itself; `fresh` is set where
 * no loss was supposed before. */
#ifndef LOST_FRAMES_H
#define LOST_FRAMES_H

#include <stdint.h>

typedef struct {
    int64_t rows, inputs, drives, slots, apart, sweeps;
    int32_t fresh;
    double first_share;
    const double *u, *answers;
    const int64_t *column;
    const uint8_t *judged;
    double *left, *lost, *arrived, *taken, *found, *power;
} loss_request;

/* Both return a lower bound of the log evidence. Frames are judged beside what is supposed of the others, in sweeps; or first all together. */
double loss_ratios(const loss_request *request);
double loss_ratios_together(const loss_request *request);

/* The probability that each frame was lost (rows), where `left` are the innovations without any loss; 0 where there is no memory. */
int likely_losses(const loss_request *request, double share, double *lost);

#endif
