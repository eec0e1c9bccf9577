#include "board.h"
#include "chip.h"

/* Not every core has a cycle counter of its own; the system timer runs freely, without its interrupt. */
void cycle_counter_start(void)
{
    SYSTICK->RVR = SYSTICK_MASK;
    SYSTICK->CVR = 0;
    SYSTICK->CSR = SYSTICK_CSR_ENABLE | SYSTICK_CSR_CORE_CLOCK;
}

uint32_t cycle_counter(void)
{
    return SYSTICK_MASK - SYSTICK->CVR;
}

uint32_t cycles_between(uint32_t start, uint32_t end)
{
    return (end - start) & SYSTICK_MASK;
}
