/* What the board tells the host: one function a message, each framed ready for the line. */
#include "path.h"
#include "words.h"

#define FILL_HEAD(message, self, now_us)                             \
    do {                                                             \
        (message).echo_sequence = (self)->link.last_sequence;        \
        (message).device_time_us = (now_us);                         \
        (message).state = (self)->supervisor.state;                  \
    } while (0)

static void copy_bytes(uint8_t *to, const uint8_t *from, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        to[i] = from[i];
    }
}

static size_t identity(path_state *self, uint32_t now_us, uint8_t *payload)
{
    static const uint8_t SCHEMA_HASH[8] = PROTOCOL_SCHEMA_HASH;
    protocol_identity message = {
        .arithmetic = LAW_ARITHMETIC_CODE,
        .sample_period_us = LAW_SAMPLE_PERIOD_US,
        .pwm_full_scale_ticks = LAW_PWM_TICKS,
        .firmware_version = PATH_FIRMWARE_VERSION,
        .reset_cause = self->identity.reset_cause,
    };
    FILL_HEAD(message, self, now_us);
    copy_bytes(message.schema_hash, SCHEMA_HASH, sizeof message.schema_hash);
    copy_bytes(message.table_digest, LAW_TABLE_DIGEST, sizeof message.table_digest);
    copy_bytes(message.unique_id, self->identity.unique_id, sizeof message.unique_id);
    protocol_identity_pack(&message, payload);
    return PROTOCOL_IDENTITY_SIZE;
}

static size_t result(path_state *self, uint32_t now_us, uint8_t *payload)
{
    protocol_result message = {.command = self->reply_to, .reason = self->reply_reason};
    FILL_HEAD(message, self, now_us);
    protocol_result_pack(&message, payload);
    return PROTOCOL_RESULT_SIZE;
}

#define VOLTAGE_WORD(angle, voltage, motor, VOLTAGE) .voltage##_V = word_of_number(self->output.voltage##_V),
#define DUTY(angle, voltage, motor, VOLTAGE) .duty_##motor##_ticks = (int16_t)self->applied.motor##_ticks,
#define COUNTS(angle, voltage, motor, VOLTAGE) .angle##_counts = self->measured.angle##_counts,
#define ANGLE_WORD(angle, voltage, motor, VOLTAGE) .angle##_rad = word_of_number(self->input.angle##_rad),
#define REFERENCE_WORD(angle, voltage, motor, VOLTAGE) .angle##_ref_rad = word_of_number(self->input.angle##_ref_rad),

static size_t answer(path_state *self, uint32_t now_us, uint8_t *payload)
{
    protocol_answer message = {
        PROTOCOL_LOOPS(VOLTAGE_WORD)
        PROTOCOL_LOOPS(DUTY)
        .law_cycles = self->law_cycles,
    };
    FILL_HEAD(message, self, now_us);
    protocol_answer_pack(&message, payload);
    return PROTOCOL_ANSWER_SIZE;
}

static size_t counters(path_state *self, uint32_t now_us, uint8_t *payload)
{
    protocol_counters message = self->link.counters;
    FILL_HEAD(message, self, now_us);
    message.uart_overruns = self->faults.uart_overruns;
    message.uart_framing_errors = self->faults.uart_framing_errors;
    message.uart_noise_errors = self->faults.uart_noise_errors;
    message.rx_ring_overflows = self->faults.rx_ring_overflows;
    message.tx_frames_dropped = self->faults.tx_frames_dropped;
    message.tick_overruns = self->faults.tick_overruns;
    message.host_losses = self->supervisor.host_losses;
    message.encoder_faults = self->supervisor.encoder_faults;
    message.resets = self->identity.resets;
    protocol_counters_pack(&message, payload);
    return PROTOCOL_COUNTERS_SIZE;
}

static size_t self_test_result(path_state *self, uint32_t now_us, uint8_t *payload)
{
    protocol_self_test_result message = {.mismatches = self->self_test_mismatches};
    FILL_HEAD(message, self, now_us);
    protocol_self_test_result_pack(&message, payload);
    return PROTOCOL_SELF_TEST_RESULT_SIZE;
}

size_t path_reply(path_state *self, uint32_t now_us, uint8_t line[PROTOCOL_LINE_MAX])
{
    uint8_t payload[PROTOCOL_PAYLOAD_MAX];
    size_t length;
    switch (self->reply_type) {
    case PROTOCOL_TYPE_IDENTITY:
        length = identity(self, now_us, payload);
        break;
    case PROTOCOL_TYPE_ANSWER:
        length = answer(self, now_us, payload);
        break;
    case PROTOCOL_TYPE_COUNTERS:
        length = counters(self, now_us, payload);
        break;
    case PROTOCOL_TYPE_SELF_TEST_RESULT:
        length = self_test_result(self, now_us, payload);
        break;
    default:
        length = result(self, now_us, payload);
        break;
    }
    return link_send(&self->link, self->reply_type, payload, length, line);
}

size_t path_telemetry(path_state *self, uint32_t now_us, uint8_t line[PROTOCOL_LINE_MAX])
{
    uint8_t payload[PROTOCOL_PAYLOAD_MAX];
    if (!self->telemetry_due) {
        return 0;
    }
    protocol_telemetry message = {
        .tick = self->tick,
        PROTOCOL_LOOPS(COUNTS)
        PROTOCOL_LOOPS(ANGLE_WORD)
        PROTOCOL_LOOPS(REFERENCE_WORD)
        PROTOCOL_LOOPS(VOLTAGE_WORD)
        PROTOCOL_LOOPS(DUTY)
        .law_cycles = self->law_cycles,
        .frames_refused = link_refused(&self->link),
        .frames_lost = self->link.counters.frames_lost,
        .tick_overruns = self->faults.tick_overruns,
    };
    FILL_HEAD(message, self, now_us);
    protocol_telemetry_pack(&message, payload);
    return link_send(&self->link, PROTOCOL_TYPE_TELEMETRY, payload, PROTOCOL_TELEMETRY_SIZE, line);
}
