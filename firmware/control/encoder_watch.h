/*
 * Are the sensors believable? The counts of an encoder alone show two faults: a jump farther than the plant can turn in a
 * sample, and an axis that does not move by one count although its motor is at full drive. An encoder that stands still
 * while its motor runs below full drive looks like a plant at rest: no count can tell them apart. An analogue sensor whose
 * wire is torn or short reads its first or last code, at which nothing that it measures is.
 */
#ifndef ENCODER_WATCH_H
#define ENCODER_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "supervisor.h"

/* Encoder positions in counts. */
#define ENCODER_COUNTS(angle, voltage, motor, VOLTAGE) int32_t angle##_counts;
typedef struct {
    PROTOCOL_LOOPS(ENCODER_COUNTS)
} encoder_counts;

#define ENCODER_STILL(angle, voltage, motor, VOLTAGE) uint32_t still_##angle; /* ticks at full drive without a count */
typedef struct {
    encoder_counts last;
    PROTOCOL_LOOPS(ENCODER_STILL)
} encoder_watch;

/* Begin a flight at `now`. */
void encoder_watch_start(encoder_watch *self, const encoder_counts *now);

/* Whether `now`, `passed` ticks after the last call, can be true; `applied` drove the motors over that time. */
bool encoder_watch_believes(
    encoder_watch *self, const encoder_counts *now, const motor_duties *applied, int32_t full_drive, uint32_t passed);

#endif
