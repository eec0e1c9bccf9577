#include "path.h"

#include "cobs.h"
#include "commands.h"
#include "integrity.h"

/* A clock that claims more is wrong, and one second is enough to have lost the host. */
#define PASSED_MAX (1000000u / LAW_SAMPLE_PERIOD_US)

void path_start(path_state *self, const board_identity *identity)
{
    *self = (path_state){.identity = *identity};
    link_start(&self->link);
    supervisor_start(&self->supervisor);
    self->self_test_mismatches = law_self_test();
    path_seal(self);
}

static uint32_t sum_of(const path_state *self)
{
    return integrity_sum((const uint8_t *)self + sizeof(link_incoming), &self->seal);
}

void path_seal(path_state *self)
{
    self->seal = sum_of(self);
}

path_demand path_receive(path_state *self, uint8_t byte)
{
    link_frame frame;
    path_demand demand = PATH_NOTHING;
    const bool ends = byte == COBS_DELIMITER && (self->link.incoming.length > 0u || self->link.incoming.overflowed);
    if (ends && sum_of(self) != self->seal) {
        return PATH_BROKEN;
    }
    if (link_receive(&self->link, byte, &frame)) {
        demand = command_obey(self, &frame);
    }
    if (ends && demand == PATH_NOTHING) {
        path_seal(self);
    }
    return demand;
}

static int32_t shifted(int32_t counts, int32_t offset)
{
    return (int32_t)((uint32_t)counts + (uint32_t)offset); /* counters wrap, they do not overflow */
}

#define SHIFTED(angle, voltage, motor, VOLTAGE) \
    .angle##_counts = shifted(measured->angle##_counts, self->offset.angle##_counts),
static void measure(path_state *self, const encoder_counts *measured)
{
    self->measured = (encoder_counts){PROTOCOL_LOOPS(SHIFTED)};
}

/* Watch periods that end with these ticks; one by one, as a Cortex-M0+ has no divide instruction. */
static uint32_t watch_periods(path_state *self, uint32_t passed)
{
    uint32_t periods = 0;
    for (uint32_t i = 0; i < passed; i++) {
        periods += LAW_SAMPLE_PERIOD_US / PROTOCOL_WATCH_PERIOD_US;
        self->watched_us += LAW_SAMPLE_PERIOD_US % PROTOCOL_WATCH_PERIOD_US;
        if (self->watched_us >= PROTOCOL_WATCH_PERIOD_US) {
            self->watched_us -= PROTOCOL_WATCH_PERIOD_US;
            periods++;
        }
    }
    return periods;
}

/* Whether the line is free of the last telemetry again. */
static bool telemetry_fits(path_state *self, uint32_t passed)
{
    self->telemetry_us += passed * LAW_SAMPLE_PERIOD_US;
    if (self->telemetry_us < PROTOCOL_TELEMETRY_LEAST_US) {
        return false;
    }
    self->telemetry_us = 0;
    return true;
}

static void supervise(path_state *self, uint32_t periods)
{
    const uint8_t before = self->supervisor.state;
    self->telemetry_due = before == PROTOCOL_STATE_FLYING || before == PROTOCOL_STATE_RAMPING;
    if (before == PROTOCOL_STATE_FLYING && periods > 0u
        && !encoder_watch_believes(&self->watch, &self->measured, &self->applied, (int32_t)LAW_PWM_TICKS, periods)) {
        supervisor_encoder_fault(&self->supervisor, &self->applied);
    }
    supervisor_tick(&self->supervisor, &self->applied, periods);
    self->telemetry_due = self->telemetry_due || self->supervisor.state == PROTOCOL_STATE_RAMPING;
    if (!supervisor_is_armed(&self->supervisor)) {
        self->output = (law_output){0};
    }
}

#define MEASURED(angle, voltage, motor, VOLTAGE) \
    self->input.angle##_rad = law_angle_from_counts_##angle(self->measured.angle##_counts);
path_demand path_tick(path_state *self, const encoder_counts *measured, uint32_t passed)
{
    const uint32_t counted = passed > PASSED_MAX ? PASSED_MAX : passed;
    if (sum_of(self) != self->seal) {
        return PATH_BROKEN;
    }
    self->tick += passed;
    self->faults.tick_overruns += passed - 1u;
    measure(self, measured);
    supervise(self, watch_periods(self, counted));
    self->telemetry_due = telemetry_fits(self, counted) && self->telemetry_due;
    if (self->supervisor.state != PROTOCOL_STATE_FLYING) {
        return PATH_NOTHING;
    }
    PROTOCOL_LOOPS(MEASURED)
    return PATH_STEP;
}

#define ANGLE(angle, voltage, motor, VOLTAGE) , self->input.angle##_rad
void path_law(path_state *self)
{
    if (self->law_reset_due) {
        law_reset(&self->law PROTOCOL_LOOPS(ANGLE));
        self->law_reset_due = false;
    }
    law_step(&self->law, &self->input, &self->output);
}

static int32_t clamped(int32_t ticks)
{
    if (ticks > (int32_t)LAW_PWM_TICKS) {
        return (int32_t)LAW_PWM_TICKS;
    }
    return ticks < -(int32_t)LAW_PWM_TICKS ? -(int32_t)LAW_PWM_TICKS : ticks;
}

#define WANTED(angle, voltage, motor, VOLTAGE) .motor##_ticks = clamped(law_duty_##motor(self->output.voltage##_V)),
const motor_duties *path_limits(path_state *self)
{
    const motor_duties wanted = {PROTOCOL_LOOPS(WANTED)};
    self->applied = supervisor_limit(&self->supervisor, &wanted);
    return &self->applied;
}
