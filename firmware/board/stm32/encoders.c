#include "board.h"
#include "chip.h"
#include "pins.h"
#include "wiring.h"

/* Quadrature on both inputs, four counts a line, glitches below 8 clocks ignored. The period of a counter is ARR + 1. */
__attribute__((unused)) static void encoder_timer_start(timer_registers *timer, uint32_t last_count)
{
    timer->CCMR1 =
        TIM_CCMR1_CC1S_TI1 | TIM_CCMR1_CC2S_TI2 | TIM_CCMR1_IC1F_8_SAMPLES | TIM_CCMR1_IC2F_8_SAMPLES;
    timer->SMCR = TIM_SMCR_SMS_BOTH_EDGES;
    timer->ARR = last_count;
    timer->CNT = 0;
    timer->CR1 = TIM_CR1_CEN;
}

#define PINS_OF_1(angle, voltage, motor, VOLTAGE)                 \
    pin_alternate(PORT_A, ELEVATION_A_PIN, ELEVATION_FUNCTION, true); \
    pin_alternate(PORT_A, ELEVATION_B_PIN, ELEVATION_FUNCTION, true);
#define PINS_OF_2(angle, voltage, motor, VOLTAGE)             \
    pin_alternate(PORT_A, AZIMUTH_A_PIN, AZIMUTH_FUNCTION, true); \
    pin_alternate(PORT_A, AZIMUTH_B_PIN, AZIMUTH_FUNCTION, true);
#define START_1(angle, voltage, motor, VOLTAGE) encoder_timer_start(TIM2, UINT32_MAX);
#define START_2(angle, voltage, motor, VOLTAGE) encoder_timer_start(TIM3, UINT16_MAX);

#define PINS_OF_ANALOGUE(angle, pin, channel, sign, origin) pin_analogue(pin);

void encoders_start(encoder_counts *self)
{
    clock_to_encoders();
    PINS_ENCODER_1(PINS_OF_1)
    PINS_ENCODER_2(PINS_OF_2)
    PINS_ENCODER_1(START_1)
    PINS_ENCODER_2(START_2)
    PINS_ANALOGUE(PINS_OF_ANALOGUE)
#if PINS_HAS_ANALOGUE
    analogue_start();
#endif
    *self = (encoder_counts){0};
}

#define READ_1(angle, voltage, motor, VOLTAGE) self->angle##_counts = (int32_t)TIM2->CNT;
/*
 * The difference of two readings modulo 2^16 has no overflow event that could be missed. The last reading is the low
 * half of the total: a bit that flips there is mended here, and one that flips above is a jump.
 */
#define READ_2(angle, voltage, motor, VOLTAGE)                                                       \
    const uint16_t angle = (uint16_t)TIM3->CNT;                                                      \
    const int16_t moved = (int16_t)(uint16_t)(angle - (uint16_t)self->angle##_counts);               \
    self->angle##_counts = (int32_t)((uint32_t)self->angle##_counts + (uint32_t)moved);

/* A converter that is silent reads beyond its last code, which the watch over the sensors does not believe. */
#define READ_ANALOGUE(angle, pin, channel, sign, origin) self->angle##_counts = (sign) * (int32_t)analogue_read(channel) + (origin);

encoder_counts encoders_read(encoder_counts *self)
{
    PINS_ANALOGUE(READ_ANALOGUE)
    PINS_ENCODER_2(READ_2)
    PINS_ENCODER_1(READ_1)
    return *self;
}
