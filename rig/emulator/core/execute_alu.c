/* Data processing: ARMv6-M ARM (DDI0419) A6.7. One cycle each (DDI0484C table 3-1, single-cycle multiplier). */
#include "handler.h"

#define RD m->core.r[ip->d]
#define RN m->core.r[ip->n]
#define RM m->core.r[ip->m]

#define ADD_WITH_FLAGS(target, first, second, carry_in)              \
    do {                                                             \
        uint32_t a = (first), b = (second);                          \
        uint64_t wide = (uint64_t)a + b + (carry_in);                \
        uint32_t sum = (uint32_t)wide;                               \
        n = z = sum;                                                 \
        c = (uint32_t)(wide >> 32);                                  \
        v = ~(a ^ b) & (a ^ sum);                                    \
        target;                                                      \
    } while (0)
/* Carry after a subtraction means "no borrow". */
#define SUBTRACT_WITH_FLAGS(target, first, second)                   \
    do {                                                             \
        uint32_t a = (first), b = (second), sum = a - b;             \
        n = z = sum;                                                 \
        c = a >= b;                                                  \
        v = (a ^ b) & (a ^ sum);                                     \
        target;                                                      \
    } while (0)

HANDLER(op_adds_reg) { ADD_WITH_FLAGS(RD = sum, RN, RM, 0); NEXT(1); }
HANDLER(op_subs_reg) { SUBTRACT_WITH_FLAGS(RD = sum, RN, RM); NEXT(1); }
HANDLER(op_adds_imm) { ADD_WITH_FLAGS(RD = sum, RN, ip->imm, 0); NEXT(1); }
HANDLER(op_subs_imm) { SUBTRACT_WITH_FLAGS(RD = sum, RN, ip->imm); NEXT(1); }
HANDLER(op_cmp_imm) { SUBTRACT_WITH_FLAGS((void)0, RN, ip->imm); NEXT(1); }
HANDLER(op_cmp) { SUBTRACT_WITH_FLAGS((void)0, RN, RM); NEXT(1); }
HANDLER(op_cmn) { ADD_WITH_FLAGS((void)sum, RN, RM, 0); NEXT(1); }
HANDLER(op_adcs) { ADD_WITH_FLAGS(RD = sum, RN, RM, c); NEXT(1); }
HANDLER(op_sbcs) { ADD_WITH_FLAGS(RD = sum, RN, ~RM, c); NEXT(1); }
HANDLER(op_rsbs) { SUBTRACT_WITH_FLAGS(RD = sum, 0, RM); NEXT(1); }

#define RESULT(expression)                    \
    do {                                      \
        uint32_t result = (expression);       \
        RD = n = z = result;                  \
    } while (0)

HANDLER(op_movs_imm) { RESULT(ip->imm); NEXT(1); }
HANDLER(op_movs_reg) { RESULT(RM); NEXT(1); }
HANDLER(op_ands) { RESULT(RN & RM); NEXT(1); }
HANDLER(op_eors) { RESULT(RN ^ RM); NEXT(1); }
HANDLER(op_orrs) { RESULT(RN | RM); NEXT(1); }
HANDLER(op_bics) { RESULT(RN & ~RM); NEXT(1); }
HANDLER(op_mvns) { RESULT(~RM); NEXT(1); }
HANDLER(op_muls) { RESULT(RN * RM); NEXT(1); }
HANDLER(op_tst) { n = z = RN & RM; NEXT(1); }

/* Immediate shifts: the decoder has turned amount 0 of LSR and ASR into 32, and LSL by 0 into a move. */
HANDLER(op_lsls_imm) {
    uint32_t value = RM;
    c = (value >> (32 - ip->imm)) & 1u;
    RESULT(value << ip->imm);
    NEXT(1);
}
HANDLER(op_lsrs_imm) {
    uint32_t value = RM;
    c = (value >> (ip->imm - 1)) & 1u;
    RESULT((uint32_t)((uint64_t)value >> ip->imm));
    NEXT(1);
}
HANDLER(op_asrs_imm) {
    int64_t value = (int32_t)RM;
    c = (uint32_t)(value >> (ip->imm - 1)) & 1u;
    RESULT((uint32_t)(value >> ip->imm));
    NEXT(1);
}

/* Register shifts use the low byte; an amount of 0 leaves the carry. */
HANDLER(op_lsls) {
    uint32_t amount = RM & 0xFFu, value = RN;
    if (amount) c = amount <= 32 ? (uint32_t)(((uint64_t)value << amount) >> 32) & 1u : 0;
    RESULT(amount < 32 ? value << amount : 0);
    NEXT(1);
}
HANDLER(op_lsrs) {
    uint32_t amount = RM & 0xFFu, value = RN;
    if (amount) c = amount <= 32 ? (uint32_t)((uint64_t)value >> (amount - 1)) & 1u : 0;
    RESULT(amount < 32 ? value >> amount : 0);
    NEXT(1);
}
HANDLER(op_asrs) {
    uint32_t amount = RM & 0xFFu;
    int64_t value = (int32_t)RN;
    if (amount > 32) amount = 32;
    if (amount) c = (uint32_t)(value >> (amount - 1)) & 1u;
    RESULT((uint32_t)(value >> amount));
    NEXT(1);
}
HANDLER(op_rors) {
    uint32_t amount = RM & 0xFFu, value = RN, turn = amount & 31u;
    uint32_t turned = turn ? (value >> turn) | (value << (32 - turn)) : value;
    if (amount) c = turned >> 31;
    RESULT(turned);
    NEXT(1);
}

HANDLER(op_sxth) { RD = (uint32_t)(int32_t)(int16_t)RM; NEXT(1); }
HANDLER(op_sxtb) { RD = (uint32_t)(int32_t)(int8_t)RM; NEXT(1); }
HANDLER(op_uxth) { RD = (uint16_t)RM; NEXT(1); }
HANDLER(op_uxtb) { RD = (uint8_t)RM; NEXT(1); }
HANDLER(op_rev) { RD = __builtin_bswap32(RM); NEXT(1); }
HANDLER(op_rev16) {
    uint32_t value = RM;
    RD = ((value >> 8) & 0x00FF00FFu) | ((value << 8) & 0xFF00FF00u);
    NEXT(1);
}
HANDLER(op_revsh) { RD = (uint32_t)(int32_t)(int16_t)__builtin_bswap16((uint16_t)RM); NEXT(1); }

/* High-register forms: `imm` is the address of the instruction + 4, what reading pc gives. */
HANDLER(op_mov_plain) { RD = RM; NEXT(1); }
HANDLER(op_cmp_high) {
    m->core.r[15] = ip->imm;
    SUBTRACT_WITH_FLAGS((void)0, RN, RM);
    NEXT(1);
}
HANDLER(op_constant) { RD = ip->imm; NEXT(1); } /* ADR */
HANDLER(op_add_sp_to_reg) { RD = m->core.r[13] + ip->imm; NEXT(1); }
HANDLER(op_nop) { NEXT(1); }
