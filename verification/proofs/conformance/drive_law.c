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

#define STATE_BYTES sizeof(law_state)

static bool read_words(FILE *file, void *to, size_t count)
{
    return fread(to, 4u, count, file) == count;
}

static void run_lane(law_state *state, const law_input *inputs, uint32_t steps, uint32_t lanes)
{
    law_output output;
    for (uint32_t step = 0; step < steps; step++) {
        law_step(state, &inputs[step * lanes], &output);
        (void)law_duty_main(output.u_M_V);
        (void)law_duty_tail(output.u_T_V);
        (void)law_duty_main(inputs[step * lanes].psi_ref_rad);
        (void)law_duty_tail(inputs[step * lanes].phi_ref_rad);
    }
    (void)law_angle_from_counts_psi((int32_t)(uint32_t)steps);
    (void)law_angle_from_counts_phi(-(int32_t)(uint32_t)steps);
}

static void run(uint32_t steps, uint32_t lanes, bool given, FILE *file)
{
    law_number(*angles)[2] = malloc(lanes * sizeof *angles);
    law_state *states = malloc(lanes * STATE_BYTES);
    law_input *inputs = malloc((size_t)steps * lanes * sizeof *inputs);
    const bool whole = read_words(file, angles, 2u * lanes)
                       && (!given || read_words(file, states, lanes * STATE_BYTES / 4u))
                       && read_words(file, inputs, (size_t)steps * lanes * 4u);
    for (uint32_t lane = 0; whole && lane < lanes; lane++) {
        law_state state;
        law_reset(&state, angles[lane][0], angles[lane][1]);
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
