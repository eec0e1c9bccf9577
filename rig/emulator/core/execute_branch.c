/* Branches, stack pointer arithmetic by high registers, and everything that enters or leaves code (DDI0419 A6.7, B1.5.8). */
#include "code.h"
#include "exceptions.h"
#include "fault.h"
#include "handler.h"
#include "stack_guard.h"

/* Taken branches cost 2 cycles, others 1; `imm` is the distance in halfwords. */
#define CONDITIONAL(name, condition)                       \
    HANDLER(name) {                                        \
        if (condition) TAKE_BRANCH((int32_t)ip->imm, 2);   \
        NEXT(1);                                           \
    }
CONDITIONAL(op_beq, z == 0)
CONDITIONAL(op_bne, z != 0)
CONDITIONAL(op_bcs, c)
CONDITIONAL(op_bcc, !c)
CONDITIONAL(op_bmi, (int32_t)n < 0)
CONDITIONAL(op_bpl, (int32_t)n >= 0)
CONDITIONAL(op_bvs, (int32_t)v < 0)
CONDITIONAL(op_bvc, (int32_t)v >= 0)
CONDITIONAL(op_bhi, c && z != 0)
CONDITIONAL(op_bls, !(c && z != 0))
CONDITIONAL(op_bge, (int32_t)(n ^ v) >= 0)
CONDITIONAL(op_blt, (int32_t)(n ^ v) < 0)
CONDITIONAL(op_bgt, z != 0 && (int32_t)(n ^ v) >= 0)
CONDITIONAL(op_ble, !(z != 0 && (int32_t)(n ^ v) >= 0))

HANDLER(op_b) { TAKE_BRANCH((int32_t)ip->imm, 2); }

/* The return address is known from the place of the instruction itself. */
HANDLER(op_bl) {
    m->core.r[14] = (pc_of(m, ip) + 4) | 1u;
    TAKE_BRANCH((int32_t)ip->imm, 3);
}

/* Go to an address known only now: bit 0 is the instruction set, and must be Thumb. */
#define JUMP_TO(target, cost)                                              \
    do {                                                                   \
        uint32_t to = (target), place = to - FLASH_BASE;                   \
        ip->count++, done++, left -= (cost), m->count.flash_stalls++;      \
        if (LIKELY(place < FLASH_BYTES && (to & 1u))) {                    \
            ip = m->flash_code + (place >> 1);                             \
            if (!LIKELY(left > 0)) JUMP service(PASS);                     \
            JUMP ip->run(PASS);                                            \
        }                                                                  \
        m->slow_address = to;                                              \
        JUMP jump_slow(PASS);                                              \
    } while (0)

HANDLER(op_bx) { JUMP_TO(m->core.r[ip->m], 2); }
HANDLER(op_blx) {
    uint32_t target = m->core.r[ip->m];
    m->core.r[14] = ip->imm; /* the return address with its Thumb bit */
    JUMP_TO(target, 2);
}
HANDLER(op_mov_pc) {
    m->core.r[15] = ip->imm;
    JUMP_TO(m->core.r[ip->m] | 1u, 2);
}
HANDLER(op_add_pc) {
    m->core.r[15] = ip->imm;
    JUMP_TO((ip->imm + m->core.r[ip->m]) | 1u, 2);
}

/* POP with pc: 3 + N cycles, N with the pc; `imm` is the register list, `cycles` its cost. */
HANDLER(op_pop_pc) {
    uint32_t sp = m->core.r[13], list = ip->imm & 0xFFu, count = (uint32_t)__builtin_popcount(list);
    uint32_t offset = sp - SRAM_BASE;
    if (offset > SRAM_BYTES - 4 * count - 4) {
        SAVE_STATE();
        fault(m, STOP_UNMAPPED, sp, 0);
        LOAD_STATE();
        JUMP service(PASS);
    }
    const uint32_t *word = (const uint32_t *)(m->sram + offset);
    for (uint32_t rest = list; rest; rest &= rest - 1) m->core.r[__builtin_ctz(rest)] = *word++;
    m->core.r[13] = sp + 4 * count + 4;
    JUMP_TO(*word, ip->cycles);
}

/* Outside flash, or not Thumb, or an EXC_RETURN value in handler mode. The jump's cycles are already charged. */
HANDLER(jump_slow) {
    SAVE_STATE();
    uint32_t to = m->slow_address;
    if (m->core.ipsr && to >> 28 == 0xFu)
        exception_return(m, to);
    else if (m->in_call && (to & ~1u) == CALL_RETURN)
        stop_run(m, STOP_RETURNED, to, 0);
    else
        go_to(m, to);
    m->deadline = m->core.now;
    LOAD_STATE();
    JUMP service(PASS);
}

static HANDLER(stack_fault) {
    SAVE_STATE();
    fault(m, STOP_STACK_LIMIT, m->slow_address, 0);
    LOAD_STATE();
    JUMP service(PASS);
}

/* The stack pointer keeps its low two bits zero whatever is written. */
#define SET_SP(value)                                                             \
    do {                                                                                 \
        uint32_t sp = (value) & ~3u;                                                     \
        if (LIKELY(stack_reaches(m, stack_in_use(m), sp))) {                             \
            m->core.r[13] = sp;                                                          \
            NEXT(1);                                                                     \
        }                                                                                \
        m->slow_address = sp;                                                            \
        JUMP stack_fault(PASS);                                                          \
    } while (0)

HANDLER(op_add_sp) { SET_SP(m->core.r[13] + ip->imm); } /* SUB as well: `imm` is negative then */
HANDLER(op_mov_high) {
    m->core.r[15] = ip->imm;
    if (ip->d == 13) SET_SP(m->core.r[ip->m]);
    m->core.r[ip->d] = m->core.r[ip->m];
    NEXT(1);
}
HANDLER(op_add_high) {
    m->core.r[15] = ip->imm;
    uint32_t sum = m->core.r[ip->d] + m->core.r[ip->m];
    if (ip->d == 13) SET_SP(sum);
    m->core.r[ip->d] = sum;
    NEXT(1);
}
