#include "board.h"
#include "chip.h"
#include "law.h"
#include "pins.h"
#include "wiring.h"

_Static_assert(LAW_PWM_TICKS >= 1000 && LAW_PWM_TICKS <= 65535, "a PWM period is 1000 to 65535 ticks of 64 MHz");

#define PWM_CLOCK_HZ 64000000u /* of the table's ticks, on every chip */
_Static_assert(BOARD_CLOCK_HZ % PWM_CLOCK_HZ == 0u, "the timer divides by whole numbers");

#define DIRECTION_OF_1(angle, voltage, motor, VOLTAGE) pin_output(PORT_B, MAIN_DIRECTION_PIN);
#define DIRECTION_OF_2(angle, voltage, motor, VOLTAGE) pin_output(PORT_B, TAIL_DIRECTION_PIN);
#define PWM_OF_1(angle, voltage, motor, VOLTAGE) pin_alternate(PORT_A, MAIN_PWM_PIN, PWM_FUNCTION, false);
#define PWM_OF_2(angle, voltage, motor, VOLTAGE) pin_alternate(PORT_A, TAIL_PWM_PIN, PWM_FUNCTION, false);

/* With MOE off and OSSI on the timer itself holds both pins low. */
void pwm_start(void)
{
    clock_to_pwm();
    TIM1->BDTR = TIM_BDTR_OSSI;
    TIM1->PSC = BOARD_CLOCK_HZ / PWM_CLOCK_HZ - 1u;
    TIM1->ARR = LAW_PWM_TICKS - 1u;
    TIM1->CCR1 = 0;
    TIM1->CCR2 = 0;
    TIM1->CCMR1 = TIM_CCMR1_OC1M_PWM1 | TIM_CCMR1_OC1PE | TIM_CCMR1_OC2M_PWM1 | TIM_CCMR1_OC2PE;
    TIM1->CCER = TIM_CCER_CC1E | TIM_CCER_CC2E;
    TIM1->EGR = TIM_EGR_UG;
    TIM1->CR1 = TIM_CR1_CEN | TIM_CR1_ARPE;
    PINS_DIRECTION_1(DIRECTION_OF_1)
    PINS_DIRECTION_2(DIRECTION_OF_2)
    PINS_PWM_1(PWM_OF_1)
    PINS_PWM_2(PWM_OF_2)
}

static uint32_t magnitude(int32_t ticks)
{
    return ticks < 0 ? 0u - (uint32_t)ticks : (uint32_t)ticks;
}

#define TURN_1(angle, voltage, motor, VOLTAGE) pin_write(PORT_B, MAIN_DIRECTION_PIN, duty->motor##_ticks < 0);
#define TURN_2(angle, voltage, motor, VOLTAGE) pin_write(PORT_B, TAIL_DIRECTION_PIN, duty->motor##_ticks < 0);
#define DRIVE_1(angle, voltage, motor, VOLTAGE) TIM1->CCR1 = magnitude(duty->motor##_ticks);
#define DRIVE_2(angle, voltage, motor, VOLTAGE) TIM1->CCR2 = magnitude(duty->motor##_ticks);

void pwm_write(const motor_duties *duty, bool power)
{
    if (!power) {
        pwm_safe();
    }
    PINS_DIRECTION_1(TURN_1)
    PINS_DIRECTION_2(TURN_2)
    PINS_PWM_1(DRIVE_1)
    PINS_PWM_2(DRIVE_2)
    if (power) {
        TIM1->BDTR = TIM_BDTR_OSSI | TIM_BDTR_MOE;
    }
}

void pwm_safe(void)
{
    TIM1->BDTR = TIM_BDTR_OSSI;
}
