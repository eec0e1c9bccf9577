/* Loads and stores (DDI0419 A6.7). 2 cycles each; LDM, STM, PUSH, POP 1 + N (DDI0484C table 3-1).
 *
 * SRAM is served here, at once; everything else by the slow path behind it, which asks the bus. A GPIO access could take
 * one cycle on the chip's I/O port; two are charged. */
#include <string.h>

#include "bus.h"
#include "fault.h"
#include "handler.h"
#include "stack_guard.h"

#define RD m->core.r[ip->d]
#define RN m->core.r[ip->n]
#define RM m->core.r[ip->m]

/* How a slow access is described: its size in bytes, and whether the value is sign-extended. */
#define SIGNED_ACCESS 0x80u

static HANDLER(memory_fault) {
    SAVE_STATE();
    fault(m, m->slow_address & ((m->slow_access & 7u) - 1u) ? STOP_UNALIGNED : STOP_UNMAPPED, m->slow_address, 0);
    LOAD_STATE();
    JUMP service(PASS);
}

static uint32_t extended(uint32_t value, uint32_t access) {
    if (access == (SIGNED_ACCESS | 2u)) return (uint32_t)(int32_t)(int16_t)value;
    if (access == (SIGNED_ACCESS | 1u)) return (uint32_t)(int32_t)(int8_t)value;
    return value;
}

static HANDLER(load_slow) {
    SAVE_STATE();
    uint32_t value = 0;
    bool done_well = bus_read(m, m->slow_address, m->slow_access & 7u, &value);
    LOAD_STATE();
    if (!done_well) JUMP service(PASS);
    RD = extended(value, m->slow_access);
    NEXT(2);
}

static HANDLER(store_slow) {
    SAVE_STATE();
    bool done_well = bus_write(m, m->slow_address, m->slow_access & 7u, RD);
    LOAD_STATE();
    if (!done_well) JUMP service(PASS);
    NEXT(2);
}

#define LOAD(name, type, access, address_of)                                                          \
    HANDLER(name) {                                                                                   \
        uint32_t address = (address_of), offset = address - SRAM_BASE;                                \
        if (LIKELY(offset < SRAM_BYTES && !(address & (sizeof(type) - 1)))) {                         \
            type value;                                                                               \
            memcpy(&value, m->sram + offset, sizeof value);                                           \
            RD = (uint32_t)(int32_t)value;                                                            \
            NEXT(2);                                                                                  \
        }                                                                                             \
        m->slow_address = address, m->slow_access = (access);                                         \
        JUMP load_slow(PASS);                                                                         \
    }
#define STORE(name, type, address_of)                                                                 \
    HANDLER(name) {                                                                                   \
        uint32_t address = (address_of), offset = address - SRAM_BASE;                                \
        if (LIKELY(offset < SRAM_BYTES && !(address & (sizeof(type) - 1)))) {                         \
            type value = (type)RD;                                                                    \
            memcpy(m->sram + offset, &value, sizeof value);                                           \
            NEXT(2);                                                                                  \
        }                                                                                             \
        m->slow_address = address, m->slow_access = sizeof(type);                                     \
        JUMP store_slow(PASS);                                                                        \
    }

LOAD(op_ldr_imm, uint32_t, 4, RN + ip->imm)
LOAD(op_ldrh_imm, uint16_t, 2, RN + ip->imm)
LOAD(op_ldrb_imm, uint8_t, 1, RN + ip->imm)
LOAD(op_ldr_reg, uint32_t, 4, RN + RM)
LOAD(op_ldrh_reg, uint16_t, 2, RN + RM)
LOAD(op_ldrb_reg, uint8_t, 1, RN + RM)
LOAD(op_ldrsh_reg, int16_t, SIGNED_ACCESS | 2, RN + RM)
LOAD(op_ldrsb_reg, int8_t, SIGNED_ACCESS | 1, RN + RM)
LOAD(op_literal, uint32_t, 4, ip->imm) /* a literal of code in RAM: its address */
STORE(op_str_imm, uint32_t, RN + ip->imm)
STORE(op_strh_imm, uint16_t, RN + ip->imm)
STORE(op_strb_imm, uint8_t, RN + ip->imm)
STORE(op_str_reg, uint32_t, RN + RM)
STORE(op_strh_reg, uint16_t, RN + RM)
STORE(op_strb_reg, uint8_t, RN + RM)

/* A literal in flash cannot change: `imm` is its value. */
HANDLER(op_literal_flash) {
    m->count.flash_stalls++;
    RD = ip->imm;
    NEXT(2);
}

/* Many words at once, anywhere: `sram_words` gives the place when all of them lie in SRAM. */
static inline uint32_t *sram_words(machine *m, uint32_t address, uint32_t words) {
    uint32_t offset = address - SRAM_BASE;
    bool inside = offset <= SRAM_BYTES - 4 * words && !(address & 3u);
    return LIKELY(inside) ? (uint32_t *)(m->sram + offset) : NULL;
}

HANDLER(op_push) {
    uint32_t list = ip->imm, words = (uint32_t)__builtin_popcount(list), sp = m->core.r[13] - 4 * words;
    uint32_t *word = sram_words(m, sp, words);
    bool allowed = stack_reaches(m, stack_in_use(m), sp);
    if (!LIKELY(word && allowed)) {
        SAVE_STATE();
        fault(m, allowed ? STOP_UNMAPPED : STOP_STACK_LIMIT, sp, 0);
        LOAD_STATE();
        JUMP service(PASS);
    }
    for (uint32_t rest = list; rest; rest &= rest - 1) *word++ = m->core.r[__builtin_ctz(rest)];
    m->core.r[13] = sp;
    NEXT(ip->cycles);
}

HANDLER(op_pop) {
    uint32_t list = ip->imm, words = (uint32_t)__builtin_popcount(list), sp = m->core.r[13];
    const uint32_t *word = sram_words(m, sp, words);
    if (!LIKELY(word)) {
        m->slow_address = sp, m->slow_access = 4;
        JUMP memory_fault(PASS);
    }
    for (uint32_t rest = list; rest; rest &= rest - 1) m->core.r[__builtin_ctz(rest)] = *word++;
    m->core.r[13] = sp + 4 * words;
    NEXT(ip->cycles);
}

/* LDM and STM reach peripherals and flash word by word. The base stays as it was when it is loaded itself. */
static HANDLER(multiple_slow) {
    SAVE_STATE();
    uint32_t address = RN;
    bool well = true;
    for (uint32_t rest = ip->imm; rest && well; rest &= rest - 1, address += 4) {
        uint32_t *reg = &m->core.r[__builtin_ctz(rest)];
        well = m->slow_access ? bus_write(m, address, 4, *reg) : bus_read(m, address, 4, reg);
    }
    LOAD_STATE();
    if (!well) JUMP service(PASS);
    if (m->slow_access || !(ip->imm >> ip->n & 1u)) RN = address;
    NEXT(ip->cycles);
}

HANDLER(op_ldm) {
    uint32_t base = RN, list = ip->imm;
    const uint32_t *word = sram_words(m, base, ip->cycles - 1u);
    if (!LIKELY(word)) {
        m->slow_access = 0;
        JUMP multiple_slow(PASS);
    }
    RN = base + 4 * (ip->cycles - 1u);
    for (uint32_t rest = list; rest; rest &= rest - 1) m->core.r[__builtin_ctz(rest)] = *word++;
    NEXT(ip->cycles);
}

HANDLER(op_stm) {
    uint32_t base = RN, list = ip->imm;
    uint32_t *word = sram_words(m, base, ip->cycles - 1u);
    if (!LIKELY(word)) {
        m->slow_access = 1;
        JUMP multiple_slow(PASS);
    }
    for (uint32_t rest = list; rest; rest &= rest - 1) *word++ = m->core.r[__builtin_ctz(rest)];
    RN = base + 4 * (ip->cycles - 1u);
    NEXT(ip->cycles);
}
