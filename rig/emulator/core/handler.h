/* How one predecoded instruction hands over to the next.
 *
 * Each instruction is a small function that ends by jumping to its successor (a guaranteed tail call). The flags, the
 * cycles left until the deadline and the instruction counter travel in host registers as arguments and are written back
 * to the machine only when something other than an instruction needs them. */
#ifndef HANDLER_H
#define HANDLER_H

#include "machine.h"

#if __has_attribute(preserve_none) && (defined(__x86_64__) || defined(__aarch64__))
#define REGISTER_CALL __attribute__((preserve_none))
#else
#define REGISTER_CALL
#endif
#define JUMP __attribute__((musttail)) return
#define LIKELY(x) __builtin_expect(!!(x), 1)

#define STATE machine *m, op *ip, int64_t left, uint64_t done, uint32_t n, uint32_t z, uint32_t c, uint32_t v
#define PASS m, ip, left, done, n, z, c, v

typedef void(REGISTER_CALL *handler)(STATE);

/* `d`, `n`, `m` are register numbers; what `imm` holds is said at each handler; `count` is how often it was executed. */
struct op {
    handler run;
    uint64_t count;
    uint32_t imm;
    uint8_t d, n, m, cycles;
};

#define HANDLER(name) REGISTER_CALL void name(STATE)

/* Count the instruction, charge its cycles and go on `step` halfwords further. */
#define NEXT_BY(step, cost)                        \
    do {                                           \
        left -= (cost); /* may be told by `ip` */  \
        ip->count++;                               \
        done++;                                    \
        ip += (step);                              \
        if (!LIKELY(left > 0)) JUMP service(PASS); \
        JUMP ip->run(PASS);                        \
    } while (0)
#define NEXT(cost) NEXT_BY(1, cost)

/* A taken branch refills the pipeline: one more flash access that the prefetch buffer could not foresee. */
#define TAKE_BRANCH(step, cost)    \
    do {                           \
        m->count.flash_stalls++;   \
        NEXT_BY(step, cost);       \
    } while (0)

#define SAVE_STATE()                                      \
    do {                                                  \
        m->core.ip = ip;                                  \
        m->core.now = m->deadline - (uint64_t)left;       \
        m->count.instructions = done;                     \
        m->core.n = n, m->core.z = z, m->core.c = c, m->core.v = v; \
    } while (0)
#define LOAD_STATE()                                      \
    do {                                                  \
        ip = m->core.ip;                                  \
        left = (int64_t)(m->deadline - m->core.now);      \
        done = m->count.instructions;                     \
        n = m->core.n, z = m->core.z, c = m->core.c, v = m->core.v; \
    } while (0)

/* Arguments that start or resume execution from the state kept in the machine. */
#define RESUME(m)                                                                                          \
    (m), (m)->core.ip, (int64_t)((m)->deadline - (m)->core.now), (m)->count.instructions, (m)->core.n, (m)->core.z, \
        (m)->core.c, (m)->core.v

HANDLER(service);          /* the deadline has come: devices, exceptions, sleep, end of the run */
HANDLER(op_predecode);     /* not decoded yet */
HANDLER(op_fetch_ram);     /* code in RAM may change, it is decoded at each execution */
HANDLER(op_fetch_fault);   /* behind the end of code */
HANDLER(op_host_break);    /* the host wants to stop here */
HANDLER(jump_slow);        /* m->slow_address is a branch target outside flash, or one without the Thumb bit */

#define EACH_HANDLER(X)                                                                                                   \
    X(op_lsls_imm) X(op_lsrs_imm) X(op_asrs_imm) X(op_movs_reg) X(op_adds_reg) X(op_subs_reg) X(op_adds_imm) X(op_subs_imm)  \
    X(op_movs_imm) X(op_cmp_imm) X(op_ands) X(op_eors) X(op_lsls) X(op_lsrs) X(op_asrs) X(op_adcs) X(op_sbcs) X(op_rors)      \
    X(op_tst) X(op_rsbs) X(op_cmp) X(op_cmn) X(op_orrs) X(op_muls) X(op_bics) X(op_mvns) X(op_add_high) X(op_cmp_high)        \
    X(op_mov_high) X(op_mov_plain) X(op_add_pc) X(op_mov_pc) X(op_bx) X(op_blx) X(op_constant) X(op_literal) X(op_literal_flash) \
    X(op_str_reg) X(op_strh_reg) X(op_strb_reg) X(op_ldrsb_reg) X(op_ldr_reg) X(op_ldrh_reg) X(op_ldrb_reg) X(op_ldrsh_reg)     \
    X(op_str_imm) X(op_ldr_imm) X(op_strb_imm) X(op_ldrb_imm) X(op_strh_imm) X(op_ldrh_imm) X(op_add_sp_to_reg) X(op_add_sp)      \
    X(op_sxth) X(op_sxtb) X(op_uxth) X(op_uxtb) X(op_push) X(op_pop) X(op_pop_pc) X(op_rev) X(op_rev16) X(op_revsh) X(op_stm) X(op_ldm) \
    X(op_beq) X(op_bne) X(op_bcs) X(op_bcc) X(op_bmi) X(op_bpl) X(op_bvs) X(op_bvc) X(op_bhi) X(op_bls) X(op_bge) X(op_blt) X(op_bgt)   \
    X(op_ble) X(op_b) X(op_bl) X(op_cps) X(op_bkpt) X(op_svc) X(op_nop) X(op_wfi) X(op_wfe) X(op_sev) X(op_msr)      \
    X(op_mrs) X(op_barrier) X(op_undefined)
#define DECLARE_HANDLER(name) HANDLER(name);
EACH_HANDLER(DECLARE_HANDLER)

#endif
