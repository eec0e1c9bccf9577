#include "path.h"

#include "commands.h"

void path_start(path_state *self, const board_identity *identity)
{
    *self = (path_state){.identity = *identity};
    link_start(&self->link);
    supervisor_start(&self->supervisor);
    self->self_test_mismatches = law_self_test();
}

path_demand path_receive(path_state *self, uint8_t byte)
{
    link_frame frame;
    if (!link_receive(&self->link, byte, &frame)) {
        return PATH_NOTHING;
    }
    return command_obey(self, &frame);
}

static int32_t shifted(int32_t counts, int32_t offset)
{
    return (int32_t)((uint32_t)counts + (uint32_t)offset); /* counters wrap, they do not overflow */
}

bool path_tick(path_state *self, const encoder_counts *measured)
{
    self->tick++;
    self->measured = (encoder_counts){
        .psi_counts = shifted(measured->psi_counts, self->offset.psi_counts),
        .phi_counts = shifted(measured->phi_counts, self->offset.phi_counts),
    };
    const uint8_t before = self->supervisor.state;
    self->telemetry_due = before == PROTOCOL_STATE_FLYING || before == PROTOCOL_STATE_RAMPING;
    supervisor_tick(&self->supervisor, &self->applied);
    self->telemetry_due = self->telemetry_due || self->supervisor.state == PROTOCOL_STATE_RAMPING;
    if (!supervisor_is_armed(&self->supervisor)) {
        self->output = (law_output){0};
    }
    if (self->supervisor.state != PROTOCOL_STATE_FLYING) {
        return false;
    }
    self->input.psi_rad = law_angle_from_counts_psi(self->measured.psi_counts);
    self->input.phi_rad = law_angle_from_counts_phi(self->measured.phi_counts);
    return true;
}

void path_law(path_state *self)
{
    if (self->law_reset_due) {
        law_reset(&self->law, self->input.psi_rad, self->input.phi_rad);
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

const duty_pair *path_limits(path_state *self)
{
    const duty_pair wanted = {
        .main_ticks = clamped(law_duty_main(self->output.u_M_V)),
        .tail_ticks = clamped(law_duty_tail(self->output.u_T_V)),
    };
    self->applied = supervisor_limit(&self->supervisor, &wanted);
    return &self->applied;
}
