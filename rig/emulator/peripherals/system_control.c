/* System control space (DDI0419 B3): SysTick, NVIC, SCB. Words only, privileged only. */
#include "exceptions.h"
#include "fault.h"
#include "peripherals.h"
#include "special_registers.h"

enum {
    SYST = 0xE000E010, SYST_END = 0xE000E020, ISER = 0xE000E100, ICER = 0xE000E180, ISPR = 0xE000E200, ICPR = 0xE000E280,
    IPR = 0xE000E400, IPR_END = 0xE000E420, CPUID = 0xE000ED00, ICSR = 0xE000ED04, VTOR = 0xE000ED08, AIRCR = 0xE000ED0C,
    SCR = 0xE000ED10, CCR = 0xE000ED14, SHPR2 = 0xE000ED1C, SHPR3 = 0xE000ED20, SHCSR = 0xE000ED24, MPU_TYPE = 0xE000ED90
};

#define PRIORITY_BITS 0xC0C0C0C0u /* two bits, four levels */
#define CPUID_M0PLUS 0x410CC601u  /* r0p1 */
#define BIT(number) (1ull << (number))

static uint32_t priorities(const machine *m, uint32_t first) {
    const uint8_t *priority = m->core.priority + first;
    return priority[0] | (uint32_t)priority[1] << 8 | (uint32_t)priority[2] << 16 | (uint32_t)priority[3] << 24;
}

static void set_priorities(machine *m, uint32_t first, uint32_t value, uint32_t implemented) {
    for (uint32_t i = 0; i < 4; i++) m->core.priority[first + i] = (uint8_t)((value & PRIORITY_BITS & implemented) >> 8 * i);
    attention(m);
}

static uint32_t icsr(const machine *m) {
    uint64_t pending = m->core.pending;
    bool interrupt = pending >> FIRST_IRQ != 0;
    return (uint32_t)(pending >> NMI & 1u) << 31 | (uint32_t)(pending >> PEND_SV & 1u) << 28 | (uint32_t)(pending >> SYS_TICK & 1u) << 26 |
           (uint32_t)interrupt << 22 | exception_waiting(m) << 12 | m->core.ipsr;
}

static void set_icsr(machine *m, uint32_t value) {
    if (value >> 31 & 1u) exception_pend(m, NMI);
    if (value >> 28 & 1u) exception_pend(m, PEND_SV);
    if (value >> 27 & 1u) m->core.pending &= ~BIT(PEND_SV);
    if (value >> 26 & 1u) exception_pend(m, SYS_TICK);
    if (value >> 25 & 1u) m->core.pending &= ~BIT(SYS_TICK);
}

static void set_aircr(machine *m, uint32_t value) {
    if (value >> 16 != 0x05FAu) return;
    if (value & 4u) m->device.reset_request = RESET_SOFTWARE; /* SYSRESETREQ */
    attention(m);
}

static bool scb_read(const machine *m, uint32_t address, uint32_t *value) {
    switch (address) {
    case CPUID: *value = CPUID_M0PLUS; return true;
    case ICSR: *value = icsr(m); return true;
    case VTOR: *value = m->core.vtor; return true;
    case AIRCR: *value = 0xFA050000u; return true;
    case SCR: *value = m->core.scr; return true;
    case CCR: *value = 0x208u; return true; /* STKALIGN and UNALIGN_TRP, fixed in ARMv6-M */
    case SHPR2: *value = priorities(m, 8); return true;
    case SHPR3: *value = priorities(m, 12); return true;
    case SHCSR: *value = (uint32_t)(m->core.pending >> SV_CALL & 1u) << 15; return true;
    case MPU_TYPE: *value = 0; return true;
    default: return false;
    }
}

static bool scb_write(machine *m, uint32_t address, uint32_t value) {
    switch (address) {
    case ICSR: set_icsr(m, value); return true;
    case VTOR: m->core.vtor = value & ~0xFFu; return true;
    case AIRCR: set_aircr(m, value); return true;
    case SCR: m->core.scr = value & 0x16u; return true;
    case CCR: return true;
    case SHPR2: set_priorities(m, 8, value, 0xFF000000u); return true;
    case SHPR3: set_priorities(m, 12, value, 0xFFFF0000u); return true;
    default: return false;
    }
}

static bool nvic_read(const machine *m, uint32_t address, uint32_t *value) {
    uint32_t pending = (uint32_t)(m->core.pending >> FIRST_IRQ);
    bool enabled = address == ISER || address == ICER, waits = address == ISPR || address == ICPR;
    bool levels = address >= IPR && address < IPR_END;
    if (enabled) *value = m->core.irq_enabled;
    if (waits) *value = pending;
    if (levels) *value = priorities(m, FIRST_IRQ + (address - IPR));
    return enabled || waits || levels;
}

static bool nvic_write(machine *m, uint32_t address, uint32_t value) {
    attention(m);
    switch (address) {
    case ISER: m->core.irq_enabled |= value; return true;
    case ICER: m->core.irq_enabled &= ~value; return true;
    case ISPR: m->core.pending |= (uint64_t)value << FIRST_IRQ; return true;
    case ICPR: m->core.pending &= ~((uint64_t)(value & ~m->core.irq_lines) << FIRST_IRQ); return true; /* a line still up asks again */
    default:
        if (address < IPR || address >= IPR_END) return false;
        set_priorities(m, FIRST_IRQ + (address - IPR), value, ~0u);
        return true;
    }
}

bool system_read(machine *m, uint32_t address, uint32_t *value) {
    if (!privileged(m)) return false;
    if (address >= SYST && address < SYST_END) return systick_read(m, address - SYST, value);
    return nvic_read(m, address, value) || scb_read(m, address, value);
}

bool system_write(machine *m, uint32_t address, uint32_t value) {
    if (!privileged(m)) return false;
    if (address >= SYST && address < SYST_END) return systick_write(m, address - SYST, value);
    return nvic_write(m, address, value) || scb_write(m, address, value);
}
