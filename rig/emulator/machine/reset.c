#include "reset.h"

#include <string.h>

#include "code.h"
#include "fault.h"
#include "peripherals.h"
#include "schedule.h"
#include "stack_guard.h"

#define RCC_CSR 24u
#define SYSTEM_MEMORY 0x1FFF0000u
#define BOOT_LOADER_PLL (7u << 29 | 1u << 28 | 12u << 8 | 2u) /* 16 MHz * 12 / 8 */

static uint32_t word_at(const machine *m, uint32_t offset) {
    uint32_t word;
    memcpy(&word, m->flash + offset, sizeof word);
    return word;
}

/* Every internal reset also pulls the reset pin (RM0444 5.1.2). */
static void note_cause(machine *m, uint32_t cause) {
    m->device.rcc.reg[RCC_CSR] |= cause | RESET_PIN;
    m->count.resets[m->count.resets_total % RESETS_KEPT] = (reset_record){cause, m->device.clock.hz ? now_ps(m) : 0};
    m->count.resets_total++;
}

/* The core starts with the stack pointer and the address that stand first among the vectors (DDI0419 B1.5.5). */
static void core_reset(machine *m, uint32_t vectors) {
    uint64_t now = m->core.now;
    m->core = (core_state){.now = now, .z = 1};
    m->core.r[13] = word_at(m, vectors) & ~3u;
    m->core.r[14] = 0xFFFFFFFFu;
    stack_reaches(m, MAIN_STACK, m->core.r[13]);
    go_to(m, word_at(m, vectors + 4));
}

void machine_reset(machine *m, uint32_t cause) {
    note_cause(m, cause);
    m->device.reset_request = 0;
    rcc_reset(m);
    m->device.systick = (systick_state){0};
    m->device.due[DEV_SYSTICK] = NEVER;
    gpio_reset(m);
    timers_reset(m);
    usart_reset(m);
    iwdg_reset(m);
    adc_reset(m);
    m->device.system_memory_at_0 = false;
    core_reset(m, 0);
    bool at_power_on = m->count.resets_total == 1;
    if (m->stop_on_reset && !at_power_on) stop_run(m, STOP_RESET, 0, cause);
    attention(m);
}

/* Its own vectors in use, system memory at 0, and the clock of AN2606 for this chip, 24 MHz from the PLL, left running. */
void boot_loader_leaves(machine *m, uint32_t flash_offset) {
    m->device.system_memory_at_0 = true;
    core_reset(m, flash_offset);
    m->core.vtor = SYSTEM_MEMORY;
    rcc_run_from_pll(m, BOOT_LOADER_PLL);
    attention(m);
}
