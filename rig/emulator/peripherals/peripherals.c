#include "peripherals.h"

#include <stddef.h>

enum { AHBENR = 0x38 / 4, IOPENR = 0x34 / 4, APBENR1 = 0x3C / 4, APBENR2 = 0x40 / 4 };

static bool read_only(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)m, (void)index, (void)offset, (void)value;
    return false;
}

/* RM0444 2.2.2 (addresses) and 5.4.13-5.4.16 (clock enable bits). */
static const block BLOCKS[] = {
    {0x40000000u, 0x6C, APBENR1, 0, 1, timer_read, timer_write},   /* TIM2 */
    {0x40000400u, 0x6C, APBENR1, 1, 2, timer_read, timer_write},   /* TIM3 */
    {0x40001000u, 0x30, APBENR1, 4, 3, timer_read, timer_write},   /* TIM6 */
    {0x40001400u, 0x30, APBENR1, 5, 4, timer_read, timer_write},   /* TIM7 */
    {0x40003000u, 0x14, 0, 0, 0, iwdg_read, iwdg_write},
    {0x40004400u, 0x30, APBENR1, 17, 0, usart_read, usart_write},  /* USART2 */
    {0x40007000u, 0x80, APBENR1, 28, 0, pwr_read, pwr_write},
    {0x40012400u, 0x30C, APBENR2, 20, 0, adc_read, adc_write},     /* ADC */
    {0x40012C00u, 0x6C, APBENR2, 11, 0, timer_read, timer_write},  /* TIM1 */
    {0x40015800u, 0x14, APBENR1, 27, 0, dbg_read, dbg_write},
    {0x40021000u, 0x64, 0, 0, 0, rcc_read, rcc_write},
    {0x40022000u, 0x40, AHBENR, 8, 0, flash_read, flash_write},
    {0x50000000u, 0x2C, IOPENR, 0, 0, gpio_read, gpio_write},
    {0x50000400u, 0x2C, IOPENR, 1, 1, gpio_read, gpio_write},
    {0x50000800u, 0x2C, IOPENR, 2, 2, gpio_read, gpio_write},
    {0x1FFF7590u, 0x54, 0, 0, 0, uid_read, read_only},
};

const block *block_at(uint32_t address) {
    for (size_t i = 0; i < sizeof BLOCKS / sizeof BLOCKS[0]; i++)
        if (address - BLOCKS[i].base < BLOCKS[i].bytes) return &BLOCKS[i];
    return NULL;
}

void device_event(machine *m, enum device device) {
    switch (device) {
    case DEV_SYSTICK: systick_event(m); break;
    case DEV_USART_TX: usart_sent(m); break;
    case DEV_USART_RX: usart_received(m); break;
    case DEV_HOST_RX: host_received(m); break;
    case DEV_IWDG: iwdg_bite(m); break;
    default: timer_event(m, (uint32_t)device - DEV_TIM1); break;
    }
}

void clock_changed(machine *m) {
    usart_reschedule(m);
    iwdg_reschedule(m);
}
