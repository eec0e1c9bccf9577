#include "code.h"

#include <stdlib.h>

#include "fault.h"

/* Each region ends with two entries that catch execution running off its end. */
#define GUARDS 2u
typedef struct { uint32_t base, bytes; } region;
static const region REGIONS[] = {{0, FLASH_BYTES}, {FLASH_BASE, FLASH_BYTES}, {SRAM_BASE, SRAM_BYTES}};
enum { ALIAS, FLASH, SRAM, REGION_COUNT };

/* The entry behind all regions stands for "no code here". */
#define ENTRIES ((2 * FLASH_BYTES + SRAM_BYTES) / 2 + REGION_COUNT * GUARDS + 1)

static op *region_code(const machine *m, uint32_t index) {
    op *first = m->code;
    for (uint32_t i = 0; i < index; i++) first += REGIONS[i].bytes / 2 + GUARDS;
    return first;
}

static void fill(op *first, uint32_t entries, handler run) {
    for (uint32_t i = 0; i < entries; i++) first[i].run = run;
}

bool code_create(machine *m) {
    m->code = calloc(ENTRIES, sizeof(op));
    if (!m->code) return false;
    m->flash_code = region_code(m, FLASH);
    fill(m->code, ENTRIES, op_fetch_fault);
    for (uint32_t i = 0; i < REGION_COUNT; i++) fill(region_code(m, i), REGIONS[i].bytes / 2, i == SRAM ? op_fetch_ram : op_predecode);
    return true;
}

void code_destroy(machine *m) { free(m->code); }

op *code_at(machine *m, uint32_t address) {
    for (uint32_t i = m->device.system_memory_at_0 ? FLASH : ALIAS; i < REGION_COUNT; i++) {
        uint32_t offset = address - REGIONS[i].base;
        if (offset < REGIONS[i].bytes) return region_code(m, i) + offset / 2;
    }
    return NULL;
}

uint32_t pc_of(const machine *m, const op *ip) {
    for (uint32_t i = 0; i < REGION_COUNT; i++) {
        uint64_t halfwords = (uint64_t)(ip - region_code(m, i));
        if (halfwords < REGIONS[i].bytes / 2 + GUARDS) return REGIONS[i].base + 2 * (uint32_t)halfwords;
    }
    return m->core.bad_pc;
}

void code_forget(machine *m, uint32_t address, uint32_t bytes) {
    uint32_t offset = address >= FLASH_BASE ? address - FLASH_BASE : address;
    if (offset >= FLASH_BYTES) return;
    /* A literal load or a two-halfword instruction up to 1 KiB before may hold a copy of these bytes. */
    uint32_t first = offset > 1024 ? (offset - 1024) / 2 : 0, last = (offset + bytes + 1) / 2;
    if (last > FLASH_BYTES / 2) last = FLASH_BYTES / 2;
    fill(region_code(m, ALIAS) + first, last - first, op_predecode);
    fill(region_code(m, FLASH) + first, last - first, op_predecode);
}

void go_to(machine *m, uint32_t target) {
    op *entry = code_at(m, target & ~1u);
    m->core.bad_pc = target & ~1u;
    m->core.ip = entry ? entry : m->code + ENTRIES - 1;
    if (!(target & 1u)) fault(m, STOP_NOT_THUMB, target, 0);
}

HANDLER(op_predecode) {
    ip->run = decode(m, ip);
    JUMP ip->run(PASS);
}

HANDLER(op_fetch_ram) {
    handler run = decode(m, ip);
    JUMP run(PASS);
}

HANDLER(op_fetch_fault) {
    SAVE_STATE();
    fault(m, STOP_UNMAPPED, pc_of(m, ip), 0);
    LOAD_STATE();
    JUMP service(PASS);
}

HANDLER(op_host_break) {
    SAVE_STATE();
    stop_run(m, STOP_HOST_BREAK, pc_of(m, ip), 0);
    LOAD_STATE();
    JUMP service(PASS);
}
