/* Vector table, memory set-up, and what happens on a fault. */
#include <stdint.h>

#include "board.h"
#include "stm32g071.h"

extern uint32_t _stack_top, _data_load, _data_start, _data_end, _bss_start, _bss_end;

int main(void);
void Reset_Handler(void);
void Fault_Handler(void);
void TIM6_Handler(void);
void USART2_Handler(void);

typedef void (*handler)(void);

typedef struct {
    uint32_t *initial_stack;
    handler system[15];        /* PM0223 2.3.4, exception numbers 1 to 15 */
    handler device[IRQ_COUNT]; /* RM0444 12.3 */
} vector_table;

/* An exception that nobody expects is a fault: the board stops safely instead of running on. */
__attribute__((section(".vectors"), used)) static const vector_table VECTORS = {
    .initial_stack = &_stack_top,
    .system = {[0] = Reset_Handler, [1 ... 14] = Fault_Handler},
    .device = {
        [0 ... IRQ_TIM6 - 1] = Fault_Handler,
        [IRQ_TIM6] = TIM6_Handler,
        [IRQ_TIM6 + 1 ... IRQ_USART2 - 1] = Fault_Handler,
        [IRQ_USART2] = USART2_Handler,
        [IRQ_USART2 + 1 ... IRQ_COUNT - 1] = Fault_Handler,
    },
};

void Reset_Handler(void)
{
    const uint32_t *from = &_data_load;
    for (uint32_t *to = &_data_start; to < &_data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = &_bss_start; to < &_bss_end; to++) {
        *to = 0;
    }
    main();
    Fault_Handler();
}

/* Rotors off, then wait for the watchdog to start the board anew. */
void Fault_Handler(void)
{
    pwm_safe();
    for (;;) {
    }
}
