#include "supervisor.h"

/* RAMP_PERIODS is a power of two: a Cortex-M0+ has no divide instruction. */
#define RAMP_SHIFT 3
_Static_assert(PROTOCOL_RAMP_PERIODS == 1u << RAMP_SHIFT, "the ramp is computed by a shift");

void supervisor_start(supervisor_state *self)
{
    *self = (supervisor_state){.state = PROTOCOL_STATE_DISARMED};
}

bool supervisor_is_armed(const supervisor_state *self)
{
    return self->state == PROTOCOL_STATE_FLYING || self->state == PROTOCOL_STATE_LOOP;
}

bool supervisor_power_allowed(const supervisor_state *self)
{
    const bool driving = self->state == PROTOCOL_STATE_FLYING || self->state == PROTOCOL_STATE_RAMPING;
    return driving && self->mode == PROTOCOL_MODE_FLYING;
}

uint8_t supervisor_arm(supervisor_state *self, uint8_t mode, bool table_matches, bool self_test_passed)
{
    if (mode != PROTOCOL_MODE_FLYING && mode != PROTOCOL_MODE_LOOP) {
        return PROTOCOL_REASON_UNKNOWN_MODE;
    }
#if PROTOCOL_HAS_PINS == 0
    if (mode == PROTOCOL_MODE_FLYING) {
        return PROTOCOL_REASON_UNKNOWN_MODE;
    }
#endif
    if (!table_matches) {
        return PROTOCOL_REASON_WRONG_TABLE;
    }
    if (!self_test_passed) {
        return PROTOCOL_REASON_SELF_TEST_FAILED;
    }
#if PROTOCOL_HAS_PINS != 0
    if (mode == PROTOCOL_MODE_FLYING && self->position_lost) {
        return PROTOCOL_REASON_POSITION_LOST;
    }
#endif
    if (supervisor_is_armed(self)) {
        return self->mode == mode ? PROTOCOL_REASON_DONE : PROTOCOL_REASON_OTHER_MODE;
    }
    self->state = mode == PROTOCOL_MODE_FLYING ? PROTOCOL_STATE_FLYING : PROTOCOL_STATE_LOOP;
    self->mode = mode;
    self->missed_samples = 0;
    return PROTOCOL_REASON_DONE;
}

void supervisor_disarm(supervisor_state *self)
{
    self->state = PROTOCOL_STATE_DISARMED;
}

void supervisor_host_alive(supervisor_state *self)
{
    self->missed_samples = 0;
}

static void start_ramp(supervisor_state *self, const motor_duties *applied)
{
    self->state = PROTOCOL_STATE_RAMPING;
    self->ramp_left = PROTOCOL_RAMP_PERIODS;
    self->ramp_start = *applied;
}

void supervisor_encoder_fault(supervisor_state *self, const motor_duties *applied)
{
    self->encoder_faults++;
    self->position_lost = true;
    start_ramp(self, applied);
}

void supervisor_position_known(supervisor_state *self)
{
    self->position_lost = false;
}

/* Ticks of the ramp that belong to this call: the one in which the host is found lost is the first of them. */
static uint32_t ticks_of_ramp(supervisor_state *self, const motor_duties *applied, uint32_t passed)
{
    if (!supervisor_is_armed(self)) {
        return passed;
    }
    self->missed_samples += passed;
    if (self->missed_samples < PROTOCOL_HOST_LOSS_PERIODS) {
        return 0;
    }
    self->host_losses++;
    start_ramp(self, applied);
    return self->missed_samples - PROTOCOL_HOST_LOSS_PERIODS + 1u;
}

void supervisor_tick(supervisor_state *self, const motor_duties *applied, uint32_t passed)
{
    const uint32_t due = ticks_of_ramp(self, applied, passed);
    if (self->state != PROTOCOL_STATE_RAMPING) {
        return;
    }
    if (self->ramp_left > PROTOCOL_RAMP_PERIODS || due >= self->ramp_left) {
        self->state = PROTOCOL_STATE_LOST;
    } else {
        self->ramp_left -= due;
    }
}

/* start * left / RAMP_PERIODS, rounded toward zero; right shifts only of what is not negative. */
static int32_t ramped(int32_t start, uint32_t left)
{
    const uint32_t magnitude = start < 0 ? 0u - (uint32_t)start : (uint32_t)start;
    const int32_t scaled = (int32_t)((magnitude * left) >> RAMP_SHIFT);
    return start < 0 ? -scaled : scaled;
}

#define RAMPED(angle, voltage, motor, VOLTAGE) .motor##_ticks = ramped(self->ramp_start.motor##_ticks, self->ramp_left),
motor_duties supervisor_limit(const supervisor_state *self, const motor_duties *wanted)
{
    if (supervisor_is_armed(self)) {
        return *wanted;
    }
    if (self->state == PROTOCOL_STATE_RAMPING) {
        return (motor_duties){PROTOCOL_LOOPS(RAMPED)};
    }
    return (motor_duties){0};
}
