/*
 * law_flight.c - a compiled law as the simulation's kernel calls a controller; no part of the firmware.
 * A flight has a known number of samples; behind the last one the law starts anew for the next flight.
 */
#include "law.h"

typedef struct {
    law_state law;
    uint32_t samples; /* of one flight */
    uint32_t done;
} law_flight;

uint32_t law_flight_size(void);
void law_flight_start(law_flight *self, uint32_t samples);
void law_flight_step(void *context, const double *reference_rad, const double *angle_rad, double *u_V);

uint32_t law_flight_size(void)
{
    return (uint32_t)sizeof(law_flight);
}

void law_flight_start(law_flight *self, uint32_t samples)
{
    *self = (law_flight){.samples = samples};
}

void law_flight_step(void *context, const double *reference_rad, const double *angle_rad, double *u_V)
{
    law_flight *const self = context;
    law_output output;
    const law_input input = {
        .psi_ref_rad = (law_number)reference_rad[0],
        .phi_ref_rad = (law_number)reference_rad[1],
        .psi_rad = (law_number)angle_rad[0],
        .phi_rad = (law_number)angle_rad[1],
    };
    if (self->done == 0u) {
        law_reset(&self->law, input.psi_rad, input.phi_rad);
    }
    law_step(&self->law, &input, &output);
    u_V[0] = (double)output.u_M_V;
    u_V[1] = (double)output.u_T_V;
    self->done = (self->done + 1u == self->samples) ? 0u : self->done + 1u;
}
