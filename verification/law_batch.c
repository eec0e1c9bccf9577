/*
 * law_batch.c - many lanes of the law in one call, for verification only; no part of the firmware.
 * A lane is one independent state; all of them make the same number of steps.
 */
#include "law.h"

uint32_t law_batch_state_words(void);
void law_batch_start(uint32_t lanes, const law_number (*angles_rad)[2], law_state *states);
void law_batch_run(uint32_t steps, uint32_t lanes, law_state *states, const law_input *inputs, law_output *outputs);
void law_batch_angles(uint32_t count, const int32_t (*counts)[2], law_number (*angles_rad)[2]);
void law_batch_duties(uint32_t count, const law_output *voltages, int32_t (*ticks)[2]);

uint32_t law_batch_state_words(void)
{
    return (uint32_t)(sizeof(law_state) / sizeof(law_number));
}

void law_batch_start(uint32_t lanes, const law_number (*angles_rad)[2], law_state *states)
{
    for (uint32_t lane = 0u; lane < lanes; lane++) {
        law_reset(&states[lane], angles_rad[lane][0], angles_rad[lane][1]);
    }
}

/* inputs and outputs hold one row of all lanes per step */
void law_batch_run(uint32_t steps, uint32_t lanes, law_state *states, const law_input *inputs, law_output *outputs)
{
    for (uint32_t step = 0u; step < steps; step++) {
        for (uint32_t lane = 0u; lane < lanes; lane++) {
            law_step(&states[lane], inputs++, outputs++);
        }
    }
}

void law_batch_angles(uint32_t count, const int32_t (*counts)[2], law_number (*angles_rad)[2])
{
    for (uint32_t index = 0u; index < count; index++) {
        angles_rad[index][0] = law_angle_from_counts_psi(counts[index][0]);
        angles_rad[index][1] = law_angle_from_counts_phi(counts[index][1]);
    }
}

void law_batch_duties(uint32_t count, const law_output *voltages, int32_t (*ticks)[2])
{
    for (uint32_t index = 0u; index < count; index++) {
        ticks[index][0] = law_duty_main(voltages[index].u_M_V);
        ticks[index][1] = law_duty_tail(voltages[index].u_T_V);
    }
}
