#include "board.h"
#include "interrupts.h"

/* Interrupts are masked over the last look, so that one that comes just before the sleep still ends it. */
void board_sleep(void)
{
    interrupts_off();
    if (!usart_waiting() && !tick_waiting()) {
        __asm volatile("dsb\n\twfi" ::: "memory");
    }
    interrupts_on();
}
