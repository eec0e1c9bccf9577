#include "commands.h"

#include "words.h"

static path_demand reply(path_state *self, uint8_t type)
{
    self->reply_type = type;
    return PATH_REPLY;
}

static path_demand reply_result(path_state *self, uint8_t command, uint8_t reason)
{
    self->reply_to = command;
    self->reply_reason = reason;
    return reply(self, PROTOCOL_TYPE_RESULT);
}

static bool same_digest(const uint8_t *head)
{
    for (size_t i = 0; i < sizeof(((protocol_arm *)0)->digest_head); i++) {
        if (head[i] != LAW_TABLE_DIGEST[i]) {
            return false;
        }
    }
    return true;
}

#define HELD(angle, voltage, motor, VOLTAGE) \
    self->input.angle##_ref_rad = law_angle_from_counts_##angle(self->measured.angle##_counts);
static path_demand arm(path_state *self, const uint8_t *payload)
{
    protocol_arm wish;
    protocol_arm_unpack(&wish, payload);
    const bool was_armed = supervisor_is_armed(&self->supervisor);
    const uint8_t reason = supervisor_arm(
        &self->supervisor, wish.mode, same_digest(wish.digest_head), self->self_test_mismatches == 0u);
    if (reason == PROTOCOL_REASON_DONE && !was_armed) {
        self->law_reset_due = true;
        self->output = (law_output){0}; /* nothing of an earlier flight until the law has run */
        encoder_watch_start(&self->watch, &self->measured);
        /* Hold the present place until the host names another. */
        PROTOCOL_LOOPS(HELD)
    }
    return reply_result(self, PROTOCOL_TYPE_ARM, reason);
}

static path_demand disarm(path_state *self)
{
    supervisor_disarm(&self->supervisor);
    return reply_result(self, PROTOCOL_TYPE_DISARM, PROTOCOL_REASON_DONE);
}

#define REFERENCE(angle, voltage, motor, VOLTAGE) self->input.angle##_ref_rad = number_of_word(wish.angle##_ref_rad);
static path_demand reference(path_state *self, const uint8_t *payload)
{
    protocol_reference wish;
    if (self->supervisor.state != PROTOCOL_STATE_FLYING) {
        return reply_result(self, PROTOCOL_TYPE_REFERENCE, PROTOCOL_REASON_NOT_ARMED);
    }
    protocol_reference_unpack(&wish, payload);
    PROTOCOL_LOOPS(REFERENCE)
    supervisor_host_alive(&self->supervisor);
    return PATH_NOTHING;
}

#define GIVEN_REFERENCE(angle, voltage, motor, VOLTAGE) .angle##_ref_rad = number_of_word(given.angle##_ref_rad),
#define GIVEN_ANGLE(angle, voltage, motor, VOLTAGE) .angle##_rad = number_of_word(given.angle##_rad),
static path_demand sample(path_state *self, const link_frame *frame)
{
    protocol_sample given;
    if (self->supervisor.state != PROTOCOL_STATE_LOOP) {
        return reply_result(self, PROTOCOL_TYPE_SAMPLE, PROTOCOL_REASON_NOT_ARMED);
    }
    supervisor_host_alive(&self->supervisor);
    self->reply_type = PROTOCOL_TYPE_ANSWER;
    if (frame->repeated) {
        return PATH_REPLY;
    }
    protocol_sample_unpack(&given, frame->payload);
    self->input = (law_input){PROTOCOL_LOOPS(GIVEN_REFERENCE) PROTOCOL_LOOPS(GIVEN_ANGLE)};
    return PATH_STEP;
}

#define START(angle, voltage, motor, VOLTAGE) , number_of_word(start.angle##_rad)
static path_demand restart_law(path_state *self, const uint8_t *payload)
{
    protocol_reset_law start;
    if (self->supervisor.state != PROTOCOL_STATE_LOOP) {
        return reply_result(self, PROTOCOL_TYPE_RESET_LAW, PROTOCOL_REASON_NOT_ARMED);
    }
    protocol_reset_law_unpack(&start, payload);
    law_reset(&self->law PROTOCOL_LOOPS(START));
    self->law_reset_due = false;
    supervisor_host_alive(&self->supervisor);
    return reply_result(self, PROTOCOL_TYPE_RESET_LAW, PROTOCOL_REASON_DONE);
}

#define MOVE_ORIGIN(angle, voltage, motor, VOLTAGE)                                                             \
    self->offset.angle##_counts = (int32_t)((uint32_t)self->offset.angle##_counts + (uint32_t)now.angle##_counts \
                                            - (uint32_t)self->measured.angle##_counts);
#define STAYS(angle, least, most) .angle##_counts = self->measured.angle##_counts, /* it knows its place by itself */
#define NOW(angle, voltage, motor, VOLTAGE) .angle##_counts = now.angle##_counts,
static path_demand preset(path_state *self, const uint8_t *payload)
{
    protocol_preset now;
    if (supervisor_is_armed(&self->supervisor)) {
        return reply_result(self, PROTOCOL_TYPE_PRESET, PROTOCOL_REASON_ARMED);
    }
    protocol_preset_unpack(&now, payload);
    PROTOCOL_ENCODER_LOOPS(MOVE_ORIGIN)
    self->measured = (encoder_counts){PROTOCOL_ENCODER_LOOPS(NOW) PROTOCOL_ANALOGUE_LOOPS(STAYS)};
    supervisor_position_known(&self->supervisor);
    return reply_result(self, PROTOCOL_TYPE_PRESET, PROTOCOL_REASON_DONE);
}

/*
 * The same frame again must not act again: a copy that a bridge or a driver held back would re-arm a board that has
 * lost its host, keep a flight alive without one, or move the origin of the encoders.
 */
static bool acts_once(uint8_t type)
{
    return type == PROTOCOL_TYPE_ARM || type == PROTOCOL_TYPE_PRESET || type == PROTOCOL_TYPE_RESET_LAW
           || type == PROTOCOL_TYPE_REFERENCE;
}

/* What the reply says is still as the first copy left it, unless its effect is gone; a taken reference has no reply. */
static path_demand reply_again(path_state *self, uint8_t type)
{
    if (self->reply_to != type) {
        return PATH_NOTHING;
    }
    if (type == PROTOCOL_TYPE_ARM && self->reply_reason == PROTOCOL_REASON_DONE
        && !supervisor_is_armed(&self->supervisor)) {
        return reply_result(self, type, PROTOCOL_REASON_NOT_ARMED);
    }
    return reply(self, PROTOCOL_TYPE_RESULT);
}

path_demand command_obey(path_state *self, const link_frame *frame)
{
    if (frame->repeated && acts_once(frame->type)) {
        return reply_again(self, frame->type);
    }
    switch (frame->type) {
    case PROTOCOL_TYPE_IDENTIFY:
        return reply(self, PROTOCOL_TYPE_IDENTITY);
    case PROTOCOL_TYPE_ARM:
        return arm(self, frame->payload);
    case PROTOCOL_TYPE_DISARM:
        return disarm(self);
    case PROTOCOL_TYPE_REFERENCE:
        return reference(self, frame->payload);
    case PROTOCOL_TYPE_SAMPLE:
        return sample(self, frame);
    case PROTOCOL_TYPE_GET_COUNTERS:
        return reply(self, PROTOCOL_TYPE_COUNTERS);
    case PROTOCOL_TYPE_SELF_TEST:
        return reply(self, PROTOCOL_TYPE_SELF_TEST_RESULT);
    case PROTOCOL_TYPE_PRESET:
        return preset(self, frame->payload);
    case PROTOCOL_TYPE_RESET_LAW:
        return restart_law(self, frame->payload);
    default:
        return PATH_NOTHING; /* the link lets no other type through */
    }
}
