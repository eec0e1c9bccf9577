/*
 * Who may drive the rotors, and what happens when the host falls silent.
 *
 *     DISARMED --arm--> FLYING or LOOP --host lost--> RAMPING --ramp done--> LOST
 *         ^                  ^                           |                    |
 *         |                  +-----------arm-------------+--------arm---------+
 *         +--disarm, from every state
 *
 * Time is counted in control ticks; the safe value of both inputs is 0 V.
 */
#ifndef SUPERVISOR_H
#define SUPERVISOR_H

#include <stdbool.h>
#include <stdint.h>

/* Signed duties of both motors in PWM ticks. */
typedef struct {
    int32_t main_ticks;
    int32_t tail_ticks;
} duty_pair;

typedef struct {
    uint8_t state;           /* PROTOCOL_STATE_... */
    uint8_t mode;            /* mode armed last, PROTOCOL_MODE_... */
    uint32_t missed_samples; /* ticks since the last setpoint of the host */
    uint32_t ramp_left;      /* ticks to the safe value */
    duty_pair ramp_start;    /* duties at the moment of the loss */
    uint32_t host_losses;
} supervisor_state;

void supervisor_start(supervisor_state *self);

/* Ask to arm in `mode`; returns PROTOCOL_REASON_... Asking again for the mode that is armed changes nothing. */
uint8_t supervisor_arm(supervisor_state *self, uint8_t mode, bool table_matches, bool self_test_passed);

void supervisor_disarm(supervisor_state *self);

/* The host sent a setpoint for the armed mode. */
void supervisor_host_alive(supervisor_state *self);

/* One control tick; `applied` are the duties that are on the motors now, from which a ramp would start. */
void supervisor_tick(supervisor_state *self, const duty_pair *applied);

/* The duties that may reach the motors in this state: the law's, the ramp's, or zero. */
duty_pair supervisor_limit(const supervisor_state *self, const duty_pair *wanted);

bool supervisor_is_armed(const supervisor_state *self);

/* Whether the power stage may be on: never in LOOP, where the plant is the host's. */
bool supervisor_power_allowed(const supervisor_state *self);

#endif
