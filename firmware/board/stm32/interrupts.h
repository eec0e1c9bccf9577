/*
 * Interrupt priorities, 0 the most urgent. The tick must be less urgent than the serial line: at 921 600 Bd a byte has
 * 10.9 us to be read, and a tick that cannot be interrupted would lose bytes.
 */
#ifndef INTERRUPTS_H
#define INTERRUPTS_H

#include <stdint.h>

#include "chip.h"

#define PRIORITY_USART 0u
#define PRIORITY_TICK 3u
_Static_assert(PRIORITY_USART < PRIORITY_TICK, "the tick must not starve the serial line");

static inline void interrupt_start(uint32_t number, uint32_t priority)
{
    const uint32_t shift = 8u * (number & 3u);
    NVIC_IPR[number >> 2] = (NVIC_IPR[number >> 2] & ~(0xffu << shift)) | (priority << (shift + 8u - PRIORITY_BITS));
    NVIC_ISER[number >> 5] = BIT(number & 31u);
}

static inline void interrupts_off(void)
{
    __asm volatile("cpsid i" ::: "memory");
}

static inline void interrupts_on(void)
{
    __asm volatile("cpsie i" ::: "memory");
}

#endif
