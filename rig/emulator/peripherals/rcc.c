/* Reset and clock control (RM0444 5.4), and the small blocks around it: flash interface, PWR, DBG, unique id. */
#include "fault.h"
#include "peripherals.h"
#include "schedule.h"

enum { CR = 0, CFGR = 2, PLLCFGR = 3, IOPRSTR = 9, APBRSTR2 = 12, IOPENR = 13, AHBENR = 14, CSR = 24 }; /* word offsets */
enum { HSION = 1 << 8, HSIRDY = 1 << 10, HSEON = 1 << 16, HSERDY = 1 << 17, PLLON = 1 << 24, PLLRDY = 1 << 25 };
enum { LSION = 1, LSIRDY = 2, RMVF = 1 << 23 };
enum { FROM_HSI = 0, FROM_PLL = 2, FROM_LSI = 3 };

/* Of a PLL that runs, only the outputs can be switched (RM0444 5.4.4): P, Q and R. */
#define PLL_OUTPUTS (1u << 16 | 1u << 24 | 1u << 28)

#define HSI_HZ 16000000ull
#define LSI_HZ 32000ull

void rcc_reset(machine *m) {
    uint32_t causes = m->device.rcc.reg[CSR] & 0xFF000000u;
    m->device.rcc = (rcc_state){0};
    m->device.rcc.reg[CR] = HSION | HSIRDY;
    m->device.rcc.reg[PLLCFGR] = 0x1000;
    m->device.rcc.reg[AHBENR] = 1u << 8;
    m->device.rcc.reg[CSR] = causes;
    m->device.flash_acr = 0x00040600u;
    for (uint32_t i = 0; i < 32; i++) m->device.pwr[i] = 0;
    m->device.pwr[0] = 0x208;
    m->device.clock = (clock_state){HSI_HZ, m->core.now, m->device.clock.hz ? now_ps(m) : 0, 1, 1};
}

static uint64_t pll_hz(const rcc_state *rcc) {
    uint32_t pll = rcc->reg[PLLCFGR];
    uint64_t divider = ((pll >> 4 & 7u) + 1ull) * ((pll >> 29) + 1ull);
    bool usable = (pll & 3u) == 2 && pll >> 28 & 1u; /* source HSI16, output R enabled */
    return usable ? HSI_HZ * (pll >> 8 & 0x7Fu) / divider : 0;
}

static uint64_t system_hz(const rcc_state *rcc) {
    switch (rcc->reg[CFGR] & 7u) {
    case FROM_HSI: return HSI_HZ >> (rcc->reg[CR] >> 11 & 7u);
    case FROM_PLL: return rcc->reg[CR] & PLLON ? pll_hz(rcc) : 0;
    case FROM_LSI: return rcc->reg[CSR] & LSION ? LSI_HZ : 0;
    default: return 0; /* no crystal on this board */
    }
}

/* HPRE: 0xxx not divided, 1000 /2 ... 1011 /16, 1100 /64 ... 1111 /512 (RM0444 5.4.3). */
static uint32_t ahb_shift(uint32_t field) {
    if (!(field & 8u)) return 0;
    uint32_t step = field & 7u;
    return step < 4 ? step + 1 : step + 2;
}

/* RM0444 3.3.4, range 1: 24 MHz per wait state. Too few would read garbage, so it stops the run. */
static void check_latency(machine *m) {
    uint64_t allowed_hz = 24000000ull * ((m->device.flash_acr & 7u) + 1);
    if (m->device.clock.hz > allowed_hz && (m->device.flash_acr & 7u) < 2)
        fault(m, STOP_FLASH_LATENCY, 0x40022000u, (uint32_t)m->device.clock.hz);
}

static bool set_clock(machine *m) {
    const rcc_state *rcc = &m->device.rcc;
    uint32_t cfgr = rcc->reg[CFGR], apb = cfgr >> 14 & 1u ? 2u << (cfgr >> 12 & 3u) : 1u;
    uint64_t hz = system_hz(rcc) >> ahb_shift(cfgr >> 8 & 15u);
    if (hz == 0) return false;
    clock_state clock = {hz, m->core.now, now_ps(m), apb, apb == 1 ? 1 : apb / 2};
    m->device.clock = clock;
    clock_changed(m);
    check_latency(m);
    attention(m);
    return true;
}

void rcc_run_from_pll(machine *m, uint32_t pllcfgr) {
    m->device.rcc.reg[PLLCFGR] = pllcfgr;
    m->device.rcc.reg[CR] |= PLLON | PLLRDY;
    m->device.rcc.reg[CFGR] = FROM_PLL << 3 | FROM_PLL;
    set_clock(m);
}

bool rcc_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    *value = m->device.rcc.reg[offset / 4];
    return true;
}

/* Oscillators and PLL are ready at once; the firmware's wait loops then run once. */
static uint32_t with_ready_flags(uint32_t cr) {
    cr &= ~(uint32_t)(HSIRDY | HSERDY | PLLRDY);
    return cr | (cr & HSION ? HSIRDY : 0) | (cr & PLLON ? PLLRDY : 0);
}

/* An oscillator that the system clock comes from cannot be switched off (RM0444 5.4.1). */
static uint32_t kept_running(const rcc_state *rcc) {
    switch (rcc->reg[CFGR] & 7u) {
    case FROM_HSI: return HSION;
    case FROM_PLL: return HSION | PLLON;
    default: return 0;
    }
}

bool rcc_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)index;
    rcc_state *rcc = &m->device.rcc;
    uint32_t *reg = &rcc->reg[offset / 4];
    bool peripheral_reset = offset / 4 >= IOPRSTR && offset / 4 <= APBRSTR2 && value != 0;
    if (peripheral_reset) return false; /* not modelled */
    switch (offset / 4) {
    case CR: *reg = with_ready_flags(value | (*reg & kept_running(rcc))); return set_clock(m);
    case CFGR: *reg = (value & ~0x38u) | (value & 7u) << 3; return set_clock(m); /* SWS follows SW */
    case PLLCFGR: *reg = rcc->reg[CR] & PLLON ? (*reg & ~PLL_OUTPUTS) | (value & PLL_OUTPUTS) : value; return set_clock(m);
    case CSR:
        *reg = (*reg & 0xFF000000u) | (value & LSION ? LSION | LSIRDY : 0);
        if (value & RMVF) *reg &= 0x00FFFFFFu;
        return true;
    default: *reg = value; return true;
    }
}

bool flash_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    *value = offset == 0 ? m->device.flash_acr : 0;
    return offset == 0 || offset == 0x10; /* ACR, and SR: never busy */
}

bool flash_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)index;
    if (offset != 0) return false; /* programming is not modelled */
    m->device.flash_acr = value;
    check_latency(m);
    return true;
}

bool pwr_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    *value = m->device.pwr[offset / 4];
    return true;
}

bool pwr_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)index;
    m->device.pwr[offset / 4] = value;
    return true;
}

#define DEVICE_ID 0x20006460u /* STM32G071, revision B (RM0444 40.10.1) */

bool dbg_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    *value = offset == 0 ? DEVICE_ID : m->device.dbg[offset / 4];
    return true;
}

bool dbg_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)index;
    m->device.dbg[offset / 4] = value;
    return true;
}

bool uid_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    bool id = offset < 12, size = offset == 0x50;
    *value = id ? m->device.uid[offset / 4] : FLASH_BYTES / 1024;
    return id || size;
}
