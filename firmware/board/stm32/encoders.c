#include "board.h"
#include "chip.h"
#include "wiring.h"

/* Quadrature on both inputs, four counts a line, glitches below 8 clocks ignored. The period of a counter is ARR + 1. */
static void encoder_timer_start(timer_registers *timer, uint32_t last_count)
{
    timer->CCMR1 =
        TIM_CCMR1_CC1S_TI1 | TIM_CCMR1_CC2S_TI2 | TIM_CCMR1_IC1F_8_SAMPLES | TIM_CCMR1_IC2F_8_SAMPLES;
    timer->SMCR = TIM_SMCR_SMS_BOTH_EDGES;
    timer->ARR = last_count;
    timer->CNT = 0;
    timer->CR1 = TIM_CR1_CEN;
}

void encoders_start(encoder_counts *self)
{
    clock_to_encoders();
    pin_alternate(PORT_A, ELEVATION_A_PIN, ELEVATION_FUNCTION, true);
    pin_alternate(PORT_A, ELEVATION_B_PIN, ELEVATION_FUNCTION, true);
    pin_alternate(PORT_A, AZIMUTH_A_PIN, AZIMUTH_FUNCTION, true);
    pin_alternate(PORT_A, AZIMUTH_B_PIN, AZIMUTH_FUNCTION, true);
    encoder_timer_start(TIM2, UINT32_MAX);
    encoder_timer_start(TIM3, UINT16_MAX);
    *self = (encoder_counts){0};
}

encoder_counts encoders_read(encoder_counts *self)
{
    /*
     * The difference of two readings modulo 2^16 has no overflow event that could be missed. The last reading is the low
     * half of the total: a bit that flips there is mended here, and one that flips above is a jump.
     */
    const uint16_t phi = (uint16_t)TIM3->CNT;
    const int16_t moved = (int16_t)(uint16_t)(phi - (uint16_t)self->phi_counts);
    self->phi_counts = (int32_t)((uint32_t)self->phi_counts + (uint32_t)moved);
    self->psi_counts = (int32_t)TIM2->CNT;
    return *self;
}
