/* ARMv6-M Thumb decoding (DDI0419 A5), once per address: a table of bit patterns, each with its operand layout. */
#include <stddef.h>

#include "bus.h"
#include "code.h"

enum layout {
    PLAIN, SHIFT, THREE_REGS, TWO_REGS_IMM3, REG_IMM8, TWO_REGS, HIGH, MOVE_HIGH, BRANCH_REG, PC_RELATIVE, LITERAL, WORD_IMM5, HALF_IMM5,
    BYTE_IMM5, SP_WORDS, SP_LOWER, SP_RAISE, PUSH, POP, MULTIPLE, CONDITION, BRANCH, IMM8, CHANGE_STATE, LONG
};

typedef struct { uint16_t mask, value; handler run; enum layout layout; } pattern;

/* Ordered: where a special case and a general one overlap, the special one stands first. */
static const pattern PATTERNS[] = {
    {0xFFC0, 0x0000, op_movs_reg, TWO_REGS}, {0xF800, 0x0000, op_lsls_imm, SHIFT}, {0xF800, 0x0800, op_lsrs_imm, SHIFT},
    {0xF800, 0x1000, op_asrs_imm, SHIFT}, {0xFE00, 0x1800, op_adds_reg, THREE_REGS}, {0xFE00, 0x1A00, op_subs_reg, THREE_REGS},
    {0xFE00, 0x1C00, op_adds_imm, TWO_REGS_IMM3}, {0xFE00, 0x1E00, op_subs_imm, TWO_REGS_IMM3}, {0xF800, 0x2000, op_movs_imm, REG_IMM8},
    {0xF800, 0x2800, op_cmp_imm, REG_IMM8}, {0xF800, 0x3000, op_adds_imm, REG_IMM8}, {0xF800, 0x3800, op_subs_imm, REG_IMM8},
    {0xFFC0, 0x4000, op_ands, TWO_REGS}, {0xFFC0, 0x4040, op_eors, TWO_REGS}, {0xFFC0, 0x4080, op_lsls, TWO_REGS},
    {0xFFC0, 0x40C0, op_lsrs, TWO_REGS}, {0xFFC0, 0x4100, op_asrs, TWO_REGS}, {0xFFC0, 0x4140, op_adcs, TWO_REGS},
    {0xFFC0, 0x4180, op_sbcs, TWO_REGS}, {0xFFC0, 0x41C0, op_rors, TWO_REGS}, {0xFFC0, 0x4200, op_tst, TWO_REGS},
    {0xFFC0, 0x4240, op_rsbs, TWO_REGS}, {0xFFC0, 0x4280, op_cmp, TWO_REGS}, {0xFFC0, 0x42C0, op_cmn, TWO_REGS},
    {0xFFC0, 0x4300, op_orrs, TWO_REGS}, {0xFFC0, 0x4340, op_muls, TWO_REGS}, {0xFFC0, 0x4380, op_bics, TWO_REGS},
    {0xFFC0, 0x43C0, op_mvns, TWO_REGS}, {0xFF87, 0x4487, op_add_pc, HIGH}, {0xFF00, 0x4400, op_add_high, HIGH},
    {0xFF00, 0x4500, op_cmp_high, HIGH}, {0xFF87, 0x4687, op_mov_pc, HIGH}, {0xFF00, 0x4600, op_mov_high, MOVE_HIGH},
    {0xFF87, 0x4700, op_bx, BRANCH_REG}, {0xFF87, 0x4780, op_blx, BRANCH_REG}, {0xF800, 0x4800, op_literal, LITERAL},
    {0xFE00, 0x5000, op_str_reg, THREE_REGS}, {0xFE00, 0x5200, op_strh_reg, THREE_REGS}, {0xFE00, 0x5400, op_strb_reg, THREE_REGS},
    {0xFE00, 0x5600, op_ldrsb_reg, THREE_REGS}, {0xFE00, 0x5800, op_ldr_reg, THREE_REGS}, {0xFE00, 0x5A00, op_ldrh_reg, THREE_REGS},
    {0xFE00, 0x5C00, op_ldrb_reg, THREE_REGS}, {0xFE00, 0x5E00, op_ldrsh_reg, THREE_REGS}, {0xF800, 0x6000, op_str_imm, WORD_IMM5},
    {0xF800, 0x6800, op_ldr_imm, WORD_IMM5}, {0xF800, 0x7000, op_strb_imm, BYTE_IMM5}, {0xF800, 0x7800, op_ldrb_imm, BYTE_IMM5},
    {0xF800, 0x8000, op_strh_imm, HALF_IMM5}, {0xF800, 0x8800, op_ldrh_imm, HALF_IMM5}, {0xF800, 0x9000, op_str_imm, SP_WORDS},
    {0xF800, 0x9800, op_ldr_imm, SP_WORDS}, {0xF800, 0xA000, op_constant, PC_RELATIVE}, {0xF800, 0xA800, op_add_sp_to_reg, SP_WORDS},
    {0xFF80, 0xB000, op_add_sp, SP_RAISE}, {0xFF80, 0xB080, op_add_sp, SP_LOWER}, {0xFFC0, 0xB200, op_sxth, TWO_REGS},
    {0xFFC0, 0xB240, op_sxtb, TWO_REGS}, {0xFFC0, 0xB280, op_uxth, TWO_REGS}, {0xFFC0, 0xB2C0, op_uxtb, TWO_REGS},
    {0xFE00, 0xB400, op_push, PUSH}, {0xFFEF, 0xB662, op_cps, CHANGE_STATE}, {0xFFC0, 0xBA00, op_rev, TWO_REGS},
    {0xFFC0, 0xBA40, op_rev16, TWO_REGS}, {0xFFC0, 0xBAC0, op_revsh, TWO_REGS}, {0xFE00, 0xBC00, op_pop, POP},
    {0xFF00, 0xBE00, op_bkpt, IMM8}, {0xFFFF, 0xBF20, op_wfe, PLAIN}, {0xFFFF, 0xBF30, op_wfi, PLAIN}, {0xFFFF, 0xBF40, op_sev, PLAIN},
    {0xFF0F, 0xBF00, op_nop, PLAIN}, {0xF800, 0xC000, op_stm, MULTIPLE}, {0xF800, 0xC800, op_ldm, MULTIPLE},
    {0xFF00, 0xD000, op_beq, CONDITION}, {0xFF00, 0xD100, op_bne, CONDITION}, {0xFF00, 0xD200, op_bcs, CONDITION},
    {0xFF00, 0xD300, op_bcc, CONDITION}, {0xFF00, 0xD400, op_bmi, CONDITION}, {0xFF00, 0xD500, op_bpl, CONDITION},
    {0xFF00, 0xD600, op_bvs, CONDITION}, {0xFF00, 0xD700, op_bvc, CONDITION}, {0xFF00, 0xD800, op_bhi, CONDITION},
    {0xFF00, 0xD900, op_bls, CONDITION}, {0xFF00, 0xDA00, op_bge, CONDITION}, {0xFF00, 0xDB00, op_blt, CONDITION},
    {0xFF00, 0xDC00, op_bgt, CONDITION}, {0xFF00, 0xDD00, op_ble, CONDITION}, {0xFF00, 0xDF00, op_svc, IMM8},
    {0xF800, 0xE000, op_b, BRANCH}, {0xF800, 0xF000, op_undefined, LONG},
};

static int32_t sign_extended(uint32_t value, uint32_t bits) { return (int32_t)(value << (32 - bits)) >> (32 - bits); }

static uint32_t halfword(machine *m, uint32_t pc) {
    const uint8_t *byte = bus_memory(m, pc, 2);
    return byte ? byte[0] | (uint32_t)byte[1] << 8 : 0xDE00u; /* permanently undefined */
}

static void set_registers(op *entry, uint32_t d, uint32_t n, uint32_t m) {
    entry->d = d & 15u, entry->n = n & 15u, entry->m = m & 15u;
}

/* Distance in halfwords to a branch target; one that leaves the region leads to the guard behind it, which faults. */
static void set_target(machine *m, op *entry, uint32_t pc, int32_t offset) {
    op *target = code_at(m, pc + 4 + (uint32_t)offset), *expected = entry + offset / 2 + 2;
    if (target == expected) {
        entry->imm = (uint32_t)(offset / 2 + 2);
        return;
    }
    op *guard = entry;
    while (code_at(m, pc_of(m, guard)) == guard) guard++;
    entry->imm = (uint32_t)(guard - entry);
}

static handler literal(machine *m, op *entry, uint32_t pc, uint32_t insn) {
    uint32_t address = ((pc + 4) & ~3u) + 4 * (insn & 0xFFu);
    set_registers(entry, insn >> 8 & 7u, 0, 0);
    entry->imm = address;
    if (pc >= SRAM_BASE) return op_literal;
    const uint8_t *byte = bus_memory(m, address, 4);
    if (!byte) return op_literal;
    entry->imm = byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
    return op_literal_flash;
}

/* The 32-bit instructions: BL, MSR, MRS, DMB, DSB, ISB (DDI0419 A5.3). */
static handler long_instruction(machine *m, op *entry, uint32_t pc, uint32_t first) {
    uint32_t second = halfword(m, pc + 2), system = second & 0xFFu;
    bool known = system <= 3 || (system >= 5 && system <= 9) || system == 16 || system == 20;
    if ((second & 0xD000u) == 0xD000u) {
        uint32_t s = first >> 10 & 1u, i1 = ~(second >> 13 ^ s) & 1u, i2 = ~(second >> 11 ^ s) & 1u;
        uint32_t offset = s << 24 | i1 << 23 | i2 << 22 | (first & 0x3FFu) << 12 | (second & 0x7FFu) << 1;
        set_target(m, entry, pc, sign_extended(offset, 25));
        return op_bl;
    }
    entry->imm = system;
    if ((first & 0xFFF0u) == 0xF380u && (second & 0xFF00u) == 0x8800u && known) {
        set_registers(entry, 0, first, 0);
        return op_msr;
    }
    if (first == 0xF3EFu && (second & 0xF000u) == 0x8000u && known) {
        set_registers(entry, second >> 8, 0, 0);
        return op_mrs;
    }
    uint32_t barrier = second & 0xFFF0u;
    if (first == 0xF3BFu && (barrier == 0x8F40u || barrier == 0x8F50u || barrier == 0x8F60u)) return op_barrier;
    return op_undefined;
}

static handler set_shift(op *entry, uint32_t insn, handler run) {
    uint32_t amount = insn >> 6 & 31u;
    set_registers(entry, insn & 7u, 0, insn >> 3 & 7u);
    entry->imm = amount == 0 ? 32 : amount;
    return run;
}

static handler set_move(op *entry, uint32_t insn, uint32_t pc, handler run) {
    set_registers(entry, (insn & 7u) | (insn >> 4 & 8u), 0, insn >> 3);
    entry->imm = pc + 4;
    return entry->d == 13 || entry->m == 15 ? run : op_mov_plain;
}

static handler set_list(op *entry, uint32_t insn, handler run, uint32_t link_register) {
    bool link = link_register && (insn & 0x100u);
    entry->imm = (insn & 0xFFu) | (link ? 1u << link_register : 0);
    entry->n = insn >> 8 & 7u;
    entry->cycles = (uint8_t)(1 + __builtin_popcount(entry->imm));
    if (!link || link_register != 15) return entry->imm ? run : op_undefined;
    entry->cycles += 2; /* 3 + N */
    return op_pop_pc;
}

static handler set_operands(machine *m, op *entry, uint32_t pc, uint32_t insn, const pattern *form);

handler decode(machine *m, op *entry) {
    uint32_t pc = pc_of(m, entry), insn = halfword(m, pc);
    for (size_t i = 0; i < sizeof PATTERNS / sizeof PATTERNS[0]; i++)
        if ((insn & PATTERNS[i].mask) == PATTERNS[i].value) return set_operands(m, entry, pc, insn, &PATTERNS[i]);
    entry->imm = insn;
    return op_undefined;
}

static handler set_operands(machine *m, op *entry, uint32_t pc, uint32_t insn, const pattern *form) {
    uint32_t low = insn & 7u, middle = insn >> 3 & 7u, high = insn >> 6 & 7u, imm5 = insn >> 6 & 31u, imm8 = insn & 0xFFu;
    entry->imm = insn;
    switch (form->layout) {
    case PLAIN: break;
    case SHIFT: return set_shift(entry, insn, form->run);
    case THREE_REGS: set_registers(entry, low, middle, high); break;
    case TWO_REGS_IMM3: set_registers(entry, low, middle, 0), entry->imm = high; break;
    case REG_IMM8: set_registers(entry, insn >> 8 & 7u, insn >> 8 & 7u, 0), entry->imm = imm8; break;
    case TWO_REGS: set_registers(entry, low, low, middle); break;
    case HIGH: set_registers(entry, low | (insn >> 4 & 8u), low | (insn >> 4 & 8u), insn >> 3), entry->imm = pc + 4; break;
    case MOVE_HIGH: return set_move(entry, insn, pc, form->run);
    case BRANCH_REG:
        set_registers(entry, 0, 0, insn >> 3), entry->imm = (pc + 2) | 1u;
        return entry->m == 15 ? op_undefined : form->run;
    case PC_RELATIVE: set_registers(entry, insn >> 8 & 7u, 0, 0), entry->imm = ((pc + 4) & ~3u) + 4 * imm8; break;
    case LITERAL: return literal(m, entry, pc, insn);
    case WORD_IMM5: set_registers(entry, low, middle, 0), entry->imm = 4 * imm5; break;
    case HALF_IMM5: set_registers(entry, low, middle, 0), entry->imm = 2 * imm5; break;
    case BYTE_IMM5: set_registers(entry, low, middle, 0), entry->imm = imm5; break;
    case SP_WORDS: set_registers(entry, insn >> 8 & 7u, 13, 0), entry->imm = 4 * imm8; break;
    case SP_RAISE: entry->imm = 4 * (insn & 0x7Fu); break;
    case SP_LOWER: entry->imm = 0u - 4 * (insn & 0x7Fu); break;
    case PUSH: return set_list(entry, insn, form->run, 14);
    case POP: return set_list(entry, insn, form->run, 15);
    case MULTIPLE: return set_list(entry, insn, form->run, 0);
    case CONDITION: set_target(m, entry, pc, 2 * sign_extended(imm8, 8)); break;
    case BRANCH: set_target(m, entry, pc, 2 * sign_extended(insn & 0x7FFu, 11)); break;
    case IMM8: entry->imm = imm8; break;
    case CHANGE_STATE: entry->imm = insn >> 4 & 1u; break;
    case LONG: return long_instruction(m, entry, pc, insn);
    }
    return form->run;
}
