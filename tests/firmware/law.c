#include "law.h"

const uint8_t LAW_TABLE_DIGEST[32] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16,
                                      17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32};

void law_reset(law_state *self, law_number psi_rad, law_number phi_rad)
{
    self->psi_start_rad = psi_rad;
    self->phi_start_rad = phi_rad;
    self->steps = 0;
}

static law_number limited(law_number u_V)
{
    return u_V > 20.0f ? 20.0f : (u_V < -20.0f ? -20.0f : u_V);
}

void law_step(law_state *self, const law_input *input, law_output *output)
{
    self->steps++;
    output->u_M_V = limited(10.0f * (input->psi_ref_rad - input->psi_rad));
    output->u_T_V = limited((law_number)self->steps * 0.001f + (input->phi_ref_rad - input->phi_rad));
}

law_number law_angle_from_counts_psi(int32_t counts)
{
    return (law_number)counts * 0.001534f;
}

law_number law_angle_from_counts_phi(int32_t counts)
{
    return (law_number)counts * 0.001534f;
}

int32_t law_duty_main(law_number u_V)
{
    return (int32_t)(u_V * 320.0f);
}

int32_t law_duty_tail(law_number u_V)
{
    return (int32_t)(u_V * 320.0f);
}

uint32_t law_self_test(void)
{
    law_state state;
    const law_input input = {.psi_ref_rad = 0.5f, .phi_ref_rad = 0.25f, .psi_rad = 0.25f, .phi_rad = 0.0f};
    law_output output;
    law_reset(&state, 0.0f, 0.0f);
    law_step(&state, &input, &output);
    return output.u_M_V == 2.5f ? 0u : 1u;
}
