#include "board.h"
#include "interrupts.h"
#include "chip.h"
#include "wiring.h"

#define COUNTS_PER_US (BOARD_CLOCK_HZ / 1000000u)

static uint32_t tick_period_us;  /* of 16 bits: fixed when the timer has started */
static volatile uint32_t ticks;  /* since the start */
static uint32_t ticks_taken;     /* by the main loop */

void TIM6_Handler(void);

void tick_start(uint32_t period_us)
{
    tick_period_us = period_us;
    clock_to_tick();
    TIM6->PSC = COUNTS_PER_US - 1u;
    TIM6->ARR = period_us - 1u;
    TIM6->EGR = TIM_EGR_UG;
    TIM6->SR = 0;
    TIM6->DIER = TIM_DIER_UIE;
    TIM6->CR1 = TIM_CR1_CEN;
    interrupt_start(IRQ_TIM6, PRIORITY_TICK);
}

void TIM6_Handler(void)
{
    TIM6->SR = ~TIM_SR_UIF;
    ticks++;
    stack_check();
}

bool tick_waiting(void)
{
    return ticks != ticks_taken;
}

uint32_t tick_take(void)
{
    const uint32_t now = ticks;
    const uint32_t passed = now - ticks_taken;
    ticks_taken = now;
    return passed;
}

uint32_t time_us(void)
{
    uint32_t before;
    uint32_t count;
    do {
        before = ticks;
        count = TIM6->CNT;
    } while (before != ticks);
    return before * tick_period_us + count;
}
