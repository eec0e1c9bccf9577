#include "encoder_watch.h"

#include "protocol.h"

void encoder_watch_start(encoder_watch *self, const encoder_counts *now)
{
    *self = (encoder_watch){.last = *now};
}

static uint32_t distance(int32_t from, int32_t to)
{
    const uint32_t moved = (uint32_t)to - (uint32_t)from; /* counters wrap, they do not overflow */
    return moved <= INT32_MAX ? moved : 0u - moved;
}

static uint32_t still_ticks(uint32_t before, uint32_t moved, int32_t duty, int32_t full_drive, uint32_t passed)
{
    const bool full = duty >= full_drive || duty <= -full_drive;
    return full && moved == 0u ? before + passed : 0u;
}

bool encoder_watch_believes(
    encoder_watch *self, const encoder_counts *now, const duty_pair *applied, int32_t full_drive, uint32_t passed)
{
    const uint32_t moved_psi = distance(self->last.psi_counts, now->psi_counts);
    const uint32_t moved_phi = distance(self->last.phi_counts, now->phi_counts);
    const uint32_t farthest = PROTOCOL_ENCODER_JUMP_COUNTS * passed;
    self->last = *now;
    self->still_psi = still_ticks(self->still_psi, moved_psi, applied->main_ticks, full_drive, passed);
    self->still_phi = still_ticks(self->still_phi, moved_phi, applied->tail_ticks, full_drive, passed);
    return moved_psi < farthest && moved_phi < farthest && self->still_psi < PROTOCOL_ENCODER_STILL_PERIODS
           && self->still_phi < PROTOCOL_ENCODER_STILL_PERIODS;
}
