/* Which peripheral answers at which address, and the functions of each. Registers are given by byte offset.
 *
 * A read or write function returns false for a register, or a feature, that is not modelled: the run then stops instead
 * of going on with a made-up answer. */
#ifndef PERIPHERALS_H
#define PERIPHERALS_H

#include "machine.h"

typedef bool (*register_read)(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
typedef bool (*register_write)(machine *m, uint32_t index, uint32_t offset, uint32_t value);

/* `enable` is the word offset of the RCC register that holds its clock enable bit, 0 when it is always clocked. */
typedef struct {
    uint32_t base, bytes, enable, enable_bit, index;
    register_read read;
    register_write write;
} block;

const block *block_at(uint32_t address);
void device_event(machine *m, enum device device);

/* System control space: SysTick, NVIC, SCB; `address` is absolute. */
bool system_read(machine *m, uint32_t address, uint32_t *value);
bool system_write(machine *m, uint32_t address, uint32_t value);
bool systick_read(machine *m, uint32_t offset, uint32_t *value);
bool systick_write(machine *m, uint32_t offset, uint32_t value);
void systick_event(machine *m);

bool rcc_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool rcc_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool flash_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool flash_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool pwr_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool pwr_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool dbg_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool dbg_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool uid_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool gpio_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool gpio_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool timer_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool timer_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool usart_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool usart_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool iwdg_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool iwdg_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);
bool adc_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value);
bool adc_write(machine *m, uint32_t index, uint32_t offset, uint32_t value);

/* Values after a reset. */
void rcc_reset(machine *m);
void gpio_reset(machine *m);
void timers_reset(machine *m);
void usart_reset(machine *m);
void iwdg_reset(machine *m);
void adc_reset(machine *m);

/* Things that happen at their time. */
void timer_event(machine *m, uint32_t index);
void usart_sent(machine *m);
void usart_received(machine *m);
void host_received(machine *m);
void iwdg_bite(machine *m);

/* The PLL as this PLLCFGR sets it becomes the system clock. */
void rcc_run_from_pll(machine *m, uint32_t pllcfgr);

/* The core clock has changed: what was planned in seconds lies at another cycle now. */
void clock_changed(machine *m);
void usart_reschedule(machine *m);
void usart_line_changed(machine *m);
void iwdg_reschedule(machine *m);

/* The host turns an encoder to an absolute count. */
void timer_set_encoder(machine *m, uint32_t index, int64_t counts);

/* The host puts a voltage on a channel, as the code that it converts to; or breaks the converter. */
void adc_set_code(machine *m, uint32_t channel, uint32_t code);
void adc_silence(machine *m);

/* The host's end of the serial line. */
void host_send(machine *m, uint8_t byte, uint64_t earliest_ps);
void host_listen(machine *m);

#endif
