/*
 * drive_control.c - the control path on this computer, led through its decisions; for coverage only, no part of the firmware.
 *
 * A host of its own speaks to it in frames, as the board's main loop would hand them on. First a random host and a random
 * plant with a fixed seed, then the situations that chance does not meet, each once.
 */
#include <stdbool.h>
#include <stdint.h>

#include "cobs.h"
#include "commands.h"
#include "crc32.h"
#include "link.h"
#include "path.h"
#include "words.h"

#define EVENTS 60000u
/* The least number of the law's periods that a watch period takes. */
#define WATCHED (LAW_SAMPLE_PERIOD_US < PROTOCOL_WATCH_PERIOD_US ? PROTOCOL_WATCH_PERIOD_US / LAW_SAMPLE_PERIOD_US : 1u)
#define FAR_COUNTS 1200 /* a reference that asks for full drive */
/* Once a loop: see PROTOCOL_LOOPS. */
#define SAME(angle, voltage, motor, VOLTAGE) .angle##_counts = counts,
#define REFERENCE(angle, voltage, motor, VOLTAGE) .angle##_ref_rad = word_of_number(law_angle_from_counts_##angle(counts)),

typedef struct {
    path_state path;
    uint16_t sequence;
    uint32_t seed;
    uint32_t now_us;
    uint8_t last[PROTOCOL_LINE_MAX + 2];
    size_t last_length;
} bench;

static uint32_t chance(bench *self, uint32_t below)
{
    self->seed = self->seed * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)(self->seed >> 8) * below) >> 24);
}

static void receive(bench *self, const uint8_t *bytes, size_t length)
{
    uint8_t line[PROTOCOL_LINE_MAX];
    for (size_t i = 0; i < length; i++) {
        const path_demand demand = path_receive(&self->path, bytes[i]);
        if (demand == PATH_STEP) {
            path_law(&self->path);
        }
        if (demand == PATH_STEP || demand == PATH_REPLY) {
            (void)path_limits(&self->path);
            (void)path_reply(&self->path, self->now_us, line);
            path_seal(&self->path);
        }
        if (demand == PATH_BROKEN) {
            path_seal(&self->path);
        }
    }
}

static encoder_counts all_at(int32_t counts)
{
    return (encoder_counts){PROTOCOL_LOOPS(SAME)};
}

/* The law's periods have passed. */
static void short_tick(bench *self, encoder_counts now, uint32_t passed)
{
    uint8_t line[PROTOCOL_LINE_MAX];
    self->now_us += LAW_SAMPLE_PERIOD_US * passed;
    if (path_tick(&self->path, &now, passed) == PATH_STEP) {
        path_law(&self->path);
    }
    (void)path_limits(&self->path);
    (void)path_telemetry(&self->path, self->now_us, line);
    (void)supervisor_power_allowed(&self->path.supervisor);
    path_seal(&self->path);
}

/* Watch periods have passed. */
static void tick(bench *self, encoder_counts now, uint32_t passed)
{
    short_tick(self, now, passed * WATCHED);
}

/* A frame of any version, type and length; the caller has filled its payload at frame + header. */
static void send_raw(bench *self, uint8_t version, uint8_t type, uint8_t *frame, size_t payload, uint32_t spoil)
{
    frame[0] = version;
    frame[1] = type;
    frame[2] = (uint8_t)(self->sequence & 0xffu);
    frame[3] = (uint8_t)(self->sequence >> 8);
    const size_t covered = PROTOCOL_HEADER_SIZE + payload;
    const uint32_t crc = crc32_of(frame, covered) ^ spoil;
    for (uint32_t i = 0; i < 4u; i++) {
        frame[covered + i] = (uint8_t)(crc >> (8u * i));
    }
    self->last_length = cobs_encode(frame, covered + 4u, self->last);
    self->last[self->last_length++] = COBS_DELIMITER;
    receive(self, self->last, self->last_length);
    self->sequence++;
}

static void send(bench *self, uint8_t type, const uint8_t *payload)
{
    uint8_t frame[2 * PROTOCOL_LINE_MAX] = {0};
    const int32_t length = protocol_length_to_board(type);
    for (int32_t i = 0; payload != NULL && i < length; i++) {
        frame[PROTOCOL_HEADER_SIZE + i] = payload[i];
    }
    send_raw(self, PROTOCOL_VERSION, type, frame, length < 0 ? 0u : (size_t)length, 0u);
}

static void again(bench *self)
{
    receive(self, self->last, self->last_length);
}

static void arm(bench *self, uint8_t mode, uint8_t first_of_digest)
{
    uint8_t payload[PROTOCOL_ARM_SIZE];
    protocol_arm wish = {.mode = mode};
    for (uint32_t i = 0; i < sizeof wish.digest_head; i++) {
        wish.digest_head[i] = LAW_TABLE_DIGEST[i];
    }
    wish.digest_head[0] ^= first_of_digest;
    protocol_arm_pack(&wish, payload);
    send(self, PROTOCOL_TYPE_ARM, payload);
}

static protocol_reference all_to(int32_t counts)
{
    return (protocol_reference){PROTOCOL_LOOPS(REFERENCE)};
}

static void refer(bench *self, const protocol_reference *wish)
{
    uint8_t payload[PROTOCOL_REFERENCE_SIZE];
    protocol_reference_pack(wish, payload);
    send(self, PROTOCOL_TYPE_REFERENCE, payload);
}

static void preset(bench *self)
{
    uint8_t payload[PROTOCOL_PRESET_SIZE];
    const int32_t counts = -3;
    const protocol_preset now = {PROTOCOL_LOOPS(SAME)};
    protocol_preset_pack(&now, payload);
    send(self, PROTOCOL_TYPE_PRESET, payload);
}

static void start(bench *self)
{
    const board_identity identity = {.unique_id = {1, 2, 3}, .reset_cause = PROTOCOL_RESET_CAUSE_WATCHDOG, .resets = 3};
    self->sequence = 0;
    path_start(&self->path, &identity);
}

#define ANY(angle, voltage, motor, VOLTAGE) now.angle##_counts = (int32_t)chance(self, 8u);
static encoder_counts anywhere(bench *self)
{
    encoder_counts now;
    PROTOCOL_LOOPS(ANY)
    return now;
}

/* Commands of any kind, repeated, skipped or from the past, whole or spoilt, between ticks of any length. */
static void random_event(bench *self)
{
    static const uint8_t TYPES[] = {
        PROTOCOL_TYPE_IDENTIFY, PROTOCOL_TYPE_ARM, PROTOCOL_TYPE_DISARM, PROTOCOL_TYPE_REFERENCE, PROTOCOL_TYPE_SAMPLE,
        PROTOCOL_TYPE_GET_COUNTERS, PROTOCOL_TYPE_SELF_TEST, PROTOCOL_TYPE_PRESET, PROTOCOL_TYPE_RESET_LAW, 0xeeu,
    };
    uint8_t payload[2 * PROTOCOL_LINE_MAX];
    for (uint32_t i = 0; i < sizeof payload; i++) {
        payload[i] = (uint8_t)chance(self, 256u);
    }
    switch (chance(self, 12u)) {
    case 0:
        arm(self, (uint8_t)chance(self, 4u), chance(self, 8u) == 0u ? 1u : 0u);
        break;
    case 1:
        again(self);
        break;
    case 2:
        self->sequence = (uint16_t)(self->sequence + chance(self, 5u));
        break;
    case 3:
        self->sequence = (uint16_t)(self->sequence - chance(self, 3u));
        break;
    case 4:
        send_raw(self, chance(self, 2u) == 0u ? PROTOCOL_VERSION : 0x55u, PROTOCOL_TYPE_SAMPLE, payload,
                 chance(self, PROTOCOL_PAYLOAD_MAX), chance(self, 2u));
        break;
    case 5:
        receive(self, payload, chance(self, PROTOCOL_LINE_MAX));
        break;
    case 6:
    case 7:
    case 8:
        tick(self, anywhere(self), chance(self, 40u) == 0u ? 300u : 1u);
        break;
    case 9:
        preset(self);
        break;
    default:
        send(self, TYPES[chance(self, sizeof TYPES)], payload);
        break;
    }
}

/* A flight in which an encoder jumps to where `then` says. */
static void jump(bench *self, encoder_counts then)
{
    start(self);
    arm(self, PROTOCOL_MODE_FLYING, 0u);
    tick(self, all_at(0), 1u);
    tick(self, then, 1u);
    arm(self, PROTOCOL_MODE_FLYING, 0u); /* the place is lost */
    arm(self, PROTOCOL_MODE_LOOP, 0u);   /* but a simulated plant may be flown */
    send(self, PROTOCOL_TYPE_DISARM, NULL);
    preset(self);
    arm(self, PROTOCOL_MODE_FLYING, 0u);
}

/* A flight in which an axis stands still although its motor is at full drive, whose sign the references decide: all axes go from 0
 * counts to `other` and back, and one whose count there is 0 stands still. */
static void stand_still(bench *self, protocol_reference wish, encoder_counts other)
{
    start(self);
    arm(self, PROTOCOL_MODE_FLYING, 0u);
    for (uint32_t i = 0; i < 2u * PROTOCOL_ENCODER_STILL_PERIODS + 200u; i++) {
        refer(self, &wish);
        tick(self, (i & 1u) != 0u ? other : all_at(0), 1u);
    }
}

/* Each axis alone: its encoder jumps either way, it stands still at full drive of either sign, it alone is to stay at 0. */
#define ALONE(angle, voltage, motor, VOLTAGE) \
    { \
        encoder_counts away = all_at(0), still = all_at(1); \
        protocol_reference stays = all_to(-FAR_COUNTS); \
        away.angle##_counts = 20000; \
        jump(self, away); \
        away.angle##_counts = -20000; \
        jump(self, away); \
        still.angle##_counts = 0; \
        stand_still(self, all_to(FAR_COUNTS), still); \
        stand_still(self, all_to(-FAR_COUNTS), still); \
        stays.angle##_ref_rad = 0u; \
        stand_still(self, stays, all_at(1)); \
    }
static void each_alone(bench *self)
{
    PROTOCOL_LOOPS(ALONE)
}

/* What ticks of another sample period bring: none of the watch's periods, one begun before, a line that is still busy. */
static void odd_ticks(bench *self)
{
    start(self);
    arm(self, PROTOCOL_MODE_FLYING, 0u);
    tick(self, all_at(0), 1u);
    tick(self, all_at(0), 0u);
    short_tick(self, all_at(0), 1u);
    self->path.watched_us = PROTOCOL_WATCH_PERIOD_US;
    path_seal(&self->path);
    tick(self, all_at(0), 1u);
}

/* Motors at full drive either way, their axes still and moving, and the ramp from there, which not every table's law asks for. */
static void watch_alone(const motor_duties *applied)
{
    const encoder_counts still = all_at(1), moved = all_at(2);
    const supervisor_state ramping = {.state = PROTOCOL_STATE_RAMPING, .ramp_start = *applied, .ramp_left = 1u};
    encoder_watch watch;
    encoder_watch_start(&watch, &still);
    (void)encoder_watch_believes(&watch, &still, applied, (int32_t)LAW_PWM_TICKS, PROTOCOL_ENCODER_STILL_PERIODS);
    (void)encoder_watch_believes(&watch, &moved, applied, (int32_t)LAW_PWM_TICKS, 1u);
    (void)supervisor_limit(&ramping, applied);
}

#define WATCH_ALONE(angle, voltage, motor, VOLTAGE) \
    watch_alone(&(motor_duties){.motor##_ticks = (int32_t)LAW_PWM_TICKS}); \
    watch_alone(&(motor_duties){.motor##_ticks = -(int32_t)LAW_PWM_TICKS});
static void watch_each(void)
{
    PROTOCOL_LOOPS(WATCH_ALONE)
}

static void lose_host(bench *self, uint32_t late)
{
    start(self);
    arm(self, PROTOCOL_MODE_FLYING, 0u);
    for (uint32_t i = 0; i < PROTOCOL_HOST_LOSS_PERIODS + 2u; i++) {
        tick(self, all_at(0), 1u);
    }
    again(self); /* the armed frame of before: it must not arm */
    tick(self, all_at(0), late);
    for (uint32_t i = 0; i < 2u * PROTOCOL_RAMP_PERIODS; i++) {
        tick(self, all_at(0), 1u);
    }
    send(self, PROTOCOL_TYPE_SAMPLE, NULL);
}

/* What the line cannot bring, because the link refuses it before, or the memory alone can. */
static void broken_memory(bench *self)
{
    uint8_t line[PROTOCOL_LINE_MAX];
    const uint8_t frame_ends = COBS_DELIMITER;
    const link_frame unknown = {.type = 0xeeu};
    const uint8_t short_frame[] = {3, PROTOCOL_VERSION, 1, COBS_DELIMITER};
    start(self);
    receive(self, short_frame, sizeof short_frame);
    self->path.link.incoming.overflowed = true;
    receive(self, &frame_ends, 1u);
    self->path.self_test_mismatches = 1u;
    path_seal(&self->path);
    arm(self, PROTOCOL_MODE_LOOP, 0u);
    start(self);
    self->path.law_cycles ^= 1u;
    send(self, PROTOCOL_TYPE_IDENTIFY, NULL);
    self->path.law_cycles ^= 1u;
    tick(self, all_at(0), 1u);
    self->path.link.incoming.length = sizeof self->path.link.incoming.bytes + 1u;
    self->path.link.incoming.overflowed = false;
    receive(self, &frame_ends, 1u);
    self->path.supervisor.state = PROTOCOL_STATE_RAMPING;
    self->path.supervisor.ramp_left = 1000u;
    path_seal(&self->path);
    tick(self, all_at(0), 1u);
    (void)command_obey(&self->path, &unknown);
    self->path.reply_type = 0xeeu;
    (void)path_reply(&self->path, 0u, line);
}

static void framing(void)
{
    uint8_t plain[600];
    uint8_t coded[COBS_ENCODED_MAX(600)];
    for (uint32_t zero_at = 0; zero_at < 520u; zero_at += 253u) {
        for (uint32_t i = 0; i < sizeof plain; i++) {
            plain[i] = i == zero_at ? 0u : (uint8_t)(1u + i % 255u);
        }
        for (size_t length = 0; length <= 512u; length += 127u) {
            (void)cobs_decode(coded, cobs_encode(plain, length, coded), plain);
        }
        (void)cobs_decode(coded, cobs_encode(plain, 254u, coded), plain);
        (void)cobs_decode(coded, cobs_encode(plain, 255u, coded), plain);
    }
    const uint8_t no_block[] = {0, 1};
    (void)cobs_decode(no_block, 0u, plain);
    (void)cobs_decode(no_block, sizeof no_block, plain);
    const uint8_t zero_inside[] = {3, 1, 0};
    (void)cobs_decode(zero_inside, sizeof zero_inside, plain);
}

/* The parts of the protocol that only the host's side uses. */
static void messages(void)
{
    static const uint8_t payload[PROTOCOL_PAYLOAD_MAX] = {0};
    uint8_t packed[PROTOCOL_PAYLOAD_MAX];
    protocol_sample sample;
    protocol_reset_law reset_law;
    protocol_identity identity;
    protocol_result result;
    protocol_answer answer;
    protocol_telemetry telemetry;
    protocol_counters counters;
    protocol_self_test_result self_test;
    protocol_sample_unpack(&sample, payload);
    protocol_sample_pack(&sample, packed);
    protocol_reset_law_unpack(&reset_law, payload);
    protocol_reset_law_pack(&reset_law, packed);
    protocol_identity_unpack(&identity, payload);
    protocol_result_unpack(&result, payload);
    protocol_answer_unpack(&answer, payload);
    protocol_telemetry_unpack(&telemetry, payload);
    protocol_counters_unpack(&counters, payload);
    protocol_self_test_result_unpack(&self_test, payload);
}

int main(void)
{
    static bench self = {.seed = 20u};
    start(&self);
    for (uint32_t i = 0; i < EVENTS; i++) {
        random_event(&self);
    }
    each_alone(&self);
    odd_ticks(&self);
    watch_each();
    lose_host(&self, 1u);
    lose_host(&self, 50u);
    broken_memory(&self);
    framing();
    messages();
    return 0;
}
