/* Vector table, memory set-up, and what happens on a fault. */
#include <stdint.h>

#include "board.h"
#include "chip.h"

extern uint32_t _stack_top, _stack_limit, _stack_guard, _data_load, _data_start, _data_end, _bss_start, _bss_end;

#define LOWER_IRQ (IRQ_TIM6 < IRQ_USART2 ? IRQ_TIM6 : IRQ_USART2)
#define UPPER_IRQ (IRQ_TIM6 < IRQ_USART2 ? IRQ_USART2 : IRQ_TIM6)
#define GUARD_WORD 0x5ac3a53cu /* no address, no small number, no float of the law */

int main(void);
void Reset_Handler(void);
void Fault_Handler(void);
void TIM6_Handler(void);
void USART2_Handler(void);

typedef void (*handler)(void);

typedef struct {
    uint32_t *initial_stack;
    handler system[15];        /* PM0223 2.3.4, exception numbers 1 to 15 */
    handler device[IRQ_COUNT]; /* chip.h */
} vector_table;

/* An exception that nobody expects is a fault: the board stops safely instead of running on. */
__attribute__((section(".vectors"), used)) static const vector_table VECTORS = {
    .initial_stack = &_stack_top,
    .system = {[0] = Reset_Handler, [1 ... 14] = Fault_Handler},
    .device = {
        [0 ... LOWER_IRQ - 1] = Fault_Handler,
        [LOWER_IRQ + 1 ... UPPER_IRQ - 1] = Fault_Handler,
        [UPPER_IRQ + 1 ... IRQ_COUNT - 1] = Fault_Handler,
        [IRQ_TIM6] = TIM6_Handler,
        [IRQ_USART2] = USART2_Handler,
    },
};

void Reset_Handler(void)
{
    SCB_VTOR = (uint32_t)&VECTORS; /* the serial boot loader, if it was first, has its own in use */
    core_start();
    const uint32_t *from = &_data_load;
    for (uint32_t *to = &_data_start; to < &_data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = &_bss_start; to < &_bss_end; to++) {
        *to = 0;
    }
    for (uint32_t *to = &_stack_guard; to < &_stack_limit; to++) {
        *to = GUARD_WORD;
    }
    main();
    board_stop();
}

/* Called by the tick's interrupt, which runs even while the main loop digs down. */
void stack_check(void)
{
    for (const uint32_t *at = &_stack_guard; at < &_stack_limit; at++) {
        if (*at != GUARD_WORD) {
            board_stop();
        }
    }
}

void Fault_Handler(void)
{
    board_stop();
}

_Noreturn void board_stop(void)
{
    pwm_safe();
    for (;;) {
    }
}
