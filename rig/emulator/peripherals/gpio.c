/* GPIO ports A, B, C (RM0444 7.4). What drives the pins from outside is set by the host. */
#include "peripherals.h"

enum { MODER = 0, IDR = 4, ODR = 5, BSRR = 6, BRR = 10 }; /* word offsets */

void gpio_reset(machine *m) {
    for (uint32_t port = 0; port < 3; port++) {
        uint32_t input = m->device.gpio[port].input;
        m->device.gpio[port] = (gpio_state){.input = input};
        m->device.gpio[port].reg[MODER] = port == 0 ? 0xEBFFFFFFu : 0xFFFFFFFFu;
    }
    m->device.gpio[0].reg[2] = 0x0C000000u; /* the debug pins */
    m->device.gpio[0].reg[3] = 0x24000000u;
}

/* An output pin reads back what it drives, an analog one reads 0. */
static uint32_t levels(const gpio_state *port) {
    uint32_t level = 0;
    for (uint32_t pin = 0; pin < 16; pin++) {
        uint32_t mode = port->reg[MODER] >> 2 * pin & 3u;
        uint32_t source = mode == 1 ? port->reg[ODR] : mode == 3 ? 0 : port->input;
        level |= source & 1u << pin;
    }
    return level;
}

bool gpio_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    const gpio_state *port = &m->device.gpio[index];
    uint32_t word = offset / 4;
    *value = word == IDR ? levels(port) : word == BSRR || word == BRR ? 0 : port->reg[word];
    return true;
}

bool gpio_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    uint32_t *reg = m->device.gpio[index].reg, word = offset / 4;
    switch (word) {
    case IDR: break;
    case ODR: reg[ODR] = value & 0xFFFFu; break;
    case BSRR: reg[ODR] = (reg[ODR] & ~(value >> 16)) | (value & 0xFFFFu); break; /* set wins over reset */
    case BRR: reg[ODR] &= ~value; break;
    default: reg[word] = value; break;
    }
    return true;
}
