/*
 * Who may drive the rotors, and what happens when the host falls silent or an encoder lies.
 *
 *     DISARMED --arm--> FLYING or LOOP --- lost ----> RAMPING --ramp done--> LOST
 *         ^                  ^                           |                    |
 *         |                  +-----------arm-------------+--------arm---------+
 *         +--disarm, from every state
 *
 * Time is counted in control ticks, those included that a late main loop has missed; the safe value of all inputs is
 * 0 V. After an encoder fault nobody knows where the plant is: FLYING is refused until PRESET has told.
 */
#ifndef SUPERVISOR_H
#define SUPERVISOR_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol.h"

/* Signed duties of all motors in PWM ticks. */
#define SUPERVISOR_DUTY(angle, voltage, motor, VOLTAGE) int32_t motor##_ticks;
typedef struct {
    PROTOCOL_LOOPS(SUPERVISOR_DUTY)
} motor_duties;

typedef struct {
    uint8_t state;           /* PROTOCOL_STATE_... */
    uint8_t mode;            /* mode armed last, PROTOCOL_MODE_... */
    uint32_t missed_samples; /* ticks since the last setpoint of the host */
    uint32_t ramp_left;      /* ticks to the safe value */
    motor_duties ramp_start;    /* duties at the moment of the loss */
    bool position_lost;      /* an encoder fault, and no PRESET since */
    uint32_t host_losses;
    uint32_t encoder_faults;
} supervisor_state;

void supervisor_start(supervisor_state *self);

/* Ask to arm in `mode`; returns PROTOCOL_REASON_... Asking again for the mode that is armed changes nothing. */
uint8_t supervisor_arm(supervisor_state *self, uint8_t mode, bool table_matches, bool self_test_passed);

void supervisor_disarm(supervisor_state *self);

/* The host sent a setpoint for the armed mode. */
void supervisor_host_alive(supervisor_state *self);

/* An encoder is not believable: leave FLYING as for a lost host. `applied` as below. */
void supervisor_encoder_fault(supervisor_state *self, const motor_duties *applied);

/* The host has told where the encoders are. */
void supervisor_position_known(supervisor_state *self);

/*
 * `passed` control ticks (more than one when the main loop was late); `applied` are the duties that are on the motors
 * now, from which a ramp would start.
 */
void supervisor_tick(supervisor_state *self, const motor_duties *applied, uint32_t passed);

/* The duties that may reach the motors in this state: the law's, the ramp's, or zero. */
motor_duties supervisor_limit(const supervisor_state *self, const motor_duties *wanted);

bool supervisor_is_armed(const supervisor_state *self);

/* Whether the power stage may be on: never in LOOP, where the plant is the host's. */
bool supervisor_power_allowed(const supervisor_state *self);

#endif
