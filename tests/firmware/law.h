/* Stand-in of the generated law, for tests of the firmware alone: u = 10 V/rad (reference - angle), plus a step
 * count; its voltages and duties go to twice the full scale, so that the limits behind it have work. */
#ifndef LAW_H
#define LAW_H

#include <stdint.h>

#define LAW_ARITHMETIC_CODE 0
#define LAW_PWM_TICKS 3200
#define LAW_SAMPLE_PERIOD_US 10000
#define LAW_U_M_SAFE_V 0.0f
#define LAW_U_T_SAFE_V 0.0f

typedef float law_number;

typedef struct {
    law_number psi_ref_rad, phi_ref_rad, psi_rad, phi_rad;
} law_input;

typedef struct {
    law_number u_M_V, u_T_V;
} law_output;

typedef struct {
    law_number psi_start_rad, phi_start_rad;
    uint32_t steps;
} law_state;

extern const uint8_t LAW_TABLE_DIGEST[32];

void law_reset(law_state *self, law_number psi_rad, law_number phi_rad);
void law_step(law_state *self, const law_input *input, law_output *output);
law_number law_angle_from_counts_psi(int32_t counts);
law_number law_angle_from_counts_phi(int32_t counts);
int32_t law_duty_main(law_number u_V);
int32_t law_duty_tail(law_number u_V);
uint32_t law_self_test(void);

#endif
