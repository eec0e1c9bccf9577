/*
 * drive_law.c - the law on this computer under recorded stimuli; for coverage only, no part of the firmware.
 *
 * stimuli.bin holds 32-bit words: per stimulus its steps, lanes and whether states are given; then angles, states, inputs.
 * Outputs, and words of any bits, go through the duties; counts of any bits through the angles.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "law.h"
#include "protocol.h"

#define STATE_BYTES sizeof(law_state)
#define ANGLE(angle, voltage, motor, VOLTAGE) law_number angle##_rad;
#define AT(angle, voltage, motor, VOLTAGE) , angles->angle##_rad
#define DUTIES(angle, voltage, motor, VOLTAGE) \
    (void)law_duty_##motor(output.voltage##_V); \
    (void)law_duty_##motor(inputs[step * lanes].angle##_ref_rad);
#define COUNTED(angle, voltage, motor, VOLTAGE) \
    (void)law_angle_from_counts_##angle((int32_t)(uint32_t)steps); \
    (void)law_angle_from_counts_##angle(-(int32_t)(uint32_t)steps);

/* Where the axes rest before the first step, in the order of the stimuli. */
typedef struct {
    PROTOCOL_LOOPS(ANGLE)
} rest_angles;

static bool read_words(FILE *file, void *to, size_t count)
{
    return fread(to, 4u, count, file) == count;
}

static void run_lane(law_state *state, const law_input *inputs, uint32_t steps, uint32_t lanes)
{
    law_output output;
    for (uint32_t step = 0; step < steps; step++) {
        law_step(state, &inputs[step * lanes], &output);
        PROTOCOL_LOOPS(DUTIES)
    }
    PROTOCOL_LOOPS(COUNTED)
}

static void rest(law_state *state, const rest_angles *angles)
{
    law_reset(state PROTOCOL_LOOPS(AT));
}

static void run(uint32_t steps, uint32_t lanes, bool given, FILE *file)
{
    rest_angles *angles = malloc(lanes * sizeof *angles);
    law_state *states = malloc(lanes * STATE_BYTES);
    law_input *inputs = malloc((size_t)steps * lanes * sizeof *inputs);
    const bool whole = read_words(file, angles, lanes * sizeof *angles / 4u)
                       && (!given || read_words(file, states, lanes * STATE_BYTES / 4u))
                       && read_words(file, inputs, (size_t)steps * lanes * sizeof *inputs / 4u);
    for (uint32_t lane = 0; whole && lane < lanes; lane++) {
        law_state state;
        rest(&state, &angles[lane]);
        run_lane(given ? &states[lane] : &state, &inputs[lane], steps, lanes);
    }
    free(angles);
    free(states);
    free(inputs);
}

/* No input is a number, nor is what is remembered of the last ones: in float32 all of these bits are NaN. */
static void run_nothing_known(void)
{
    law_state state;
    law_input input;
    law_output output;
    (void)memset(&state, 0xff, sizeof state);
    (void)memset(&input, 0xff, sizeof input);
    law_step(&state, &input, &output);
}

int main(void)
{
    uint32_t head[3];
    FILE *file = fopen("stimuli.bin", "rb");
    if (file == NULL) {
        return 2;
    }
    while (read_words(file, head, 3u)) {
        run(head[0], head[1], head[2] != 0u, file);
    }
    (void)fclose(file);
    run_nothing_known();
    return law_self_test() == 0u ? 0 : 1;
}
