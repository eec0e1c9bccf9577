#include "encoder_watch.h"

void encoder_watch_start(encoder_watch *self, const encoder_counts *now)
{
    *self = (encoder_watch){.last = *now};
}

#define OF_ENCODERS __attribute__((unused)) static /* a table without them leaves these out */

OF_ENCODERS uint32_t distance(int32_t from, int32_t to)
{
    const uint32_t moved = (uint32_t)to - (uint32_t)from; /* counters wrap, they do not overflow */
    return moved <= INT32_MAX ? moved : 0u - moved;
}

OF_ENCODERS uint32_t still_ticks(uint32_t before, uint32_t moved, int32_t duty, int32_t full_drive, uint32_t passed)
{
    const bool full = duty >= full_drive || duty <= -full_drive;
    return full && moved == 0u ? before + passed : 0u;
}

#define MOVED(angle, voltage, motor, VOLTAGE) \
    const uint32_t moved_##angle = distance(self->last.angle##_counts, now->angle##_counts);
#define STILL(angle, voltage, motor, VOLTAGE) \
    self->still_##angle = still_ticks(self->still_##angle, moved_##angle, applied->motor##_ticks, full_drive, passed);
#define NEAR(angle, voltage, motor, VOLTAGE) \
    if (moved_##angle >= farthest) { \
        return false; \
    }
#define TURNING(angle, voltage, motor, VOLTAGE) \
    if (self->still_##angle >= PROTOCOL_ENCODER_STILL_PERIODS) { \
        return false; \
    }
#define OFF_ITS_ENDS(angle, least, most) \
    if (now->angle##_counts <= (least) || now->angle##_counts >= (most)) { \
        return false; \
    }

bool encoder_watch_believes(
    encoder_watch *self, const encoder_counts *now, const motor_duties *applied, int32_t full_drive, uint32_t passed)
{
    PROTOCOL_ENCODER_LOOPS(MOVED)
    const uint32_t farthest = PROTOCOL_ENCODER_JUMP_COUNTS * passed;
    self->last = *now;
    PROTOCOL_ENCODER_LOOPS(STILL)
    (void)farthest;
    (void)applied;
    (void)full_drive;
    PROTOCOL_ENCODER_LOOPS(NEAR)
    PROTOCOL_ENCODER_LOOPS(TURNING)
    PROTOCOL_ANALOGUE_LOOPS(OFF_ITS_ENDS)
    return true;
}
