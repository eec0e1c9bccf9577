/* The whole emulated STM32G071 as one structure: core, memories, peripherals, counters.
 *
 * Every function takes the machine it works on; there is no state elsewhere, so several boards live side by side.
 * FLASH_BASE, FLASH_BYTES, SRAM_BASE and SRAM_BYTES are given by native.py, from the record of the chip.
 * Time is counted in core clock cycles (`cycle`) and, where the core clock may change underneath, in picoseconds (`_ps`). */
#ifndef MACHINE_H
#define MACHINE_H

#include <stdbool.h>
#include <stdint.h>

#include "devices.h"

#define CALL_RETURN 0x0F000000u /* nothing is mapped here: a host call has returned when the pc arrives */
#define NEVER UINT64_MAX
#define VECTORS 48u /* 16 exceptions of the core, 32 interrupts of the chip */

enum exception { NMI = 2, HARD_FAULT = 3, SV_CALL = 11, PEND_SV = 14, SYS_TICK = 15, FIRST_IRQ = 16 };
enum stack { MAIN_STACK = 0, PROCESS_STACK = 1 };

/* Why a run ended. Kinds from STOP_UNMAPPED on are faults. */
enum stop_kind {
    STOP_NONE, STOP_LIMIT, STOP_HOST_BYTES, STOP_RETURNED, STOP_HOST_BREAK, STOP_RESET,
    STOP_UNMAPPED, STOP_UNALIGNED, STOP_UNDEFINED, STOP_NOT_THUMB, STOP_STACK_LIMIT, STOP_BREAKPOINT, STOP_LOCKUP,
    STOP_BAD_RETURN, STOP_SVC_ESCALATED, STOP_UNCLOCKED, STOP_UNMODELLED, STOP_FLASH_LATENCY, STOP_FLASH_WRITE
};

typedef struct machine machine;
typedef struct op op;

/* What the host is told about the end of a run. */
typedef struct { uint32_t kind, pc, address, detail; } stop_record;

/* Registers and exception state of the core (ARMv6-M ARM, DDI0419, B1.4 and B3.4). */
typedef struct {
    uint32_t r[16];         /* r[13] is the stack pointer in use; r[15] is scratch, the place is `ip` */
    uint32_t other_sp;      /* the stack pointer not in use */
    uint32_t n, z, c, v;    /* N is bit 31 of n, Z is z == 0, C is c (0 or 1), V is bit 31 of v */
    uint32_t primask, control, ipsr;
    uint32_t sleeping, waits_for_event, event;
    uint64_t pending, active; /* one bit per exception number */
    uint32_t irq_enabled, irq_lines;
    uint8_t priority[VECTORS];
    uint32_t vtor, scr;
    uint32_t bad_pc;        /* where execution went when it left all code */
    op *ip;                 /* the next instruction */
    uint64_t now;           /* cycles since power-on */
} core_state;

/* Always-on counters; only the host clears them. */
typedef struct {
    uint64_t instructions, flash_stalls;
    uint64_t exceptions[VECTORS];
    uint32_t lowest_sp[2]; /* per stack */
    uint32_t resets_total;
    reset_record resets[RESETS_KEPT];
} counters;

struct machine {
    core_state core;
    device_state device;
    counters count;
    stop_record stop;
    uint64_t deadline;      /* first cycle at which something other than the next instruction must happen */
    uint64_t limit_cycle, limit_ps;
    uint64_t host_bytes_wanted;
    uint32_t stack_limit;   /* 0: not checked */
    bool stop_on_fault, stop_on_reset, in_call;
    uint32_t slow_address, slow_access; /* from a load or store to its slow path */
    op *code;               /* predecoded instructions of all code regions, see core/decode.c */
    op *flash_code;         /* those of the flash at its own address */
    _Alignas(8) uint8_t sram[SRAM_BYTES];
    _Alignas(8) uint8_t flash[FLASH_BYTES];
};

#endif
