/*
 * The control path without hardware, shared by the board and by the tests on a computer:
 *
 *     sensors -> commands of the line -> supervisor -> law -> limits -> outputs -> telemetry
 *
 * All state is in one structure of the caller. Numbers of the law cross the line as their raw 32-bit words.
 */
#ifndef PATH_H
#define PATH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "exchange.h"
#include "law.h"
#include "link.h"
#include "protocol.h"

#define PATH_FIRMWARE_VERSION 0x0002u /* major * 256 + minor */
_Static_assert(LAW_SAMPLE_PERIOD_US >= 500 && LAW_SAMPLE_PERIOD_US <= 50000, "a step below fills the period, the watchdog bites above");
#define PATH_SAFE(angle, voltage, motor, VOLTAGE) \
    _Static_assert(PROTOCOL_HAS_PINS == 0 || LAW_##VOLTAGE##_SAFE_V == 0, "the safe state of a board is an open power stage, 0 V");
PROTOCOL_LOOPS(PATH_SAFE)
_Static_assert(sizeof(law_number) == 4, "numbers cross the line as 32-bit words");
_Static_assert(LAW_PWM_TICKS <= INT16_MAX, "duties cross the line as int16_t");

/* What a byte off the line, or a control tick, asks the main loop to do. */
typedef enum {
    PATH_NOTHING,
    PATH_REPLY,  /* send path_reply() */
    PATH_STEP,   /* run the law once, then go on as without */
    PATH_BROKEN, /* the state is not as it was left: stop safely and start anew */
} path_demand;

/*
 * All but the incoming bytes, which have a CRC of their own, lies under `seal` while nothing is worked on: path_receive()
 * and path_tick() look whether it holds, path_seal() renews it when the work that they asked for is done.
 */
typedef struct {
    link_state link; /* first, and in it first the incoming bytes */
    supervisor_state supervisor;
    law_state law;
    law_input input;
    law_output output;
    bool law_reset_due; /* the next step starts the law at the angles of its input */
    motor_duties applied;
    uint32_t law_cycles; /* of the last step, measured by the board */
    uint32_t tick;
    uint32_t watched_us;   /* since the last watch period ended */
    uint32_t telemetry_us; /* since the last telemetry, PROTOCOL_TELEMETRY_LEAST_US at most */
    encoder_counts measured; /* encoders as last read */
    encoder_counts offset;   /* of PRESET */
    uint32_t self_test_mismatches;
    uint8_t reply_type;   /* message that path_reply() builds */
    uint8_t reply_to;     /* command that a RESULT answers */
    uint8_t reply_reason; /* PROTOCOL_REASON_... of a RESULT */
    bool telemetry_due;
    encoder_watch watch;
    board_identity identity;
    board_faults faults;
    uint32_t seal; /* last */
} path_state;
_Static_assert(offsetof(path_state, link) == 0 && offsetof(link_state, incoming) == 0, "the incoming bytes come first");
_Static_assert(sizeof(link_incoming) % 4u == 0 && offsetof(path_state, seal) % 4u == 0, "the seal is over whole words");

/* Disarmed, with the law's self-test run once: it may last longer than a control step has, so never later. */
void path_start(path_state *self, const board_identity *identity);

/* Take one byte off the line and obey the command that it may complete. */
path_demand path_receive(path_state *self, uint8_t byte);

/* Begin a control tick with the encoders as read now, `passed` ticks after the last; PATH_STEP when flying. */
path_demand path_tick(path_state *self, const encoder_counts *measured, uint32_t passed);

/* The work is done: from here on the state must not change by itself. */
void path_seal(path_state *self);

/* One step of the law on the present input. */
void path_law(path_state *self);

/* The duties that may reach the motors now; they are remembered as applied. */
const motor_duties *path_limits(path_state *self);

/* Frame the reply to the last command into `line`; returns the bytes to send. */
size_t path_reply(path_state *self, uint32_t now_us, uint8_t line[PROTOCOL_LINE_MAX]);

/* Frame the telemetry of this tick into `line`; returns the bytes to send, 0 when none is due. */
size_t path_telemetry(path_state *self, uint32_t now_us, uint8_t line[PROTOCOL_LINE_MAX]);

#endif
