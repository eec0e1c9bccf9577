#include "host.h"

#include <stdlib.h>
#include <string.h>

#include "bus.h"
#include "code.h"
#include "fault.h"
#include "peripherals.h"
#include "reset.h"
#include "schedule.h"
#include "special_registers.h"

machine *emulator_create(const uint8_t *flash, uint32_t bytes, const uint32_t *unique_id) {
    machine *m = calloc(1, sizeof(machine));
    if (!m || !code_create(m)) return NULL;
    memset(m->flash, 0xFF, FLASH_BYTES);
    memcpy(m->flash, flash, bytes < FLASH_BYTES ? bytes : FLASH_BYTES);
    memcpy(m->device.uid, unique_id, sizeof m->device.uid);
    for (uint32_t i = 0; i < DEVICES; i++) m->device.due[i] = NEVER;
    m->device.host.to_board = line_create();
    m->device.host.to_host = line_create();
    m->device.host.inbox = inbox_create();
    m->count.lowest_sp[MAIN_STACK] = m->count.lowest_sp[PROCESS_STACK] = UINT32_MAX;
    m->stop_on_fault = true;
    return m;
}

void emulator_destroy(machine *m) {
    line_destroy(m->device.host.to_board);
    line_destroy(m->device.host.to_host);
    inbox_destroy(m->device.host.inbox);
    code_destroy(m);
    free(m);
}

void emulator_configure(machine *m, uint32_t stop_on_fault, uint32_t stop_on_reset, uint32_t stack_limit, uint64_t host_bit_ps) {
    m->stop_on_fault = stop_on_fault;
    m->stop_on_reset = stop_on_reset;
    m->stack_limit = stack_limit;
    m->device.host.bit_ps = host_bit_ps;
}

void emulator_set_host_bit(machine *m, uint64_t bit_ps) {
    m->device.host.bit_ps = bit_ps;
    host_listen(m);
}

void emulator_reset(machine *m, uint32_t cause) {
    m->stop = (stop_record){0};
    machine_reset(m, cause);
}

void emulator_boot_loader_leaves(machine *m, uint32_t flash_offset) {
    m->stop = (stop_record){0};
    boot_loader_leaves(m, flash_offset);
}

/* Execute the one instruction under a host break, so that the run can go on behind it. */
static void step_over_break(machine *m) {
    handler real = decode(m, m->core.ip);
    m->limit_cycle = m->core.now + 1;
    m->deadline = m->limit_cycle;
    real(RESUME(m));
    if (m->stop.kind == STOP_LIMIT) m->stop = (stop_record){0};
}

void emulator_run(machine *m, uint64_t limit_cycle, uint64_t limit_ps, uint64_t host_bytes) {
    m->stop = (stop_record){0};
    m->limit_ps = limit_ps;
    m->host_bytes_wanted = host_bytes;
    if (m->core.ip->run == op_host_break && !m->core.sleeping) step_over_break(m);
    if (m->stop.kind != STOP_NONE) return;
    m->limit_cycle = limit_cycle;
    attention(m);
    service(RESUME(m));
}

void emulator_status(machine *m, machine_status *out) {
    const core_state *core = &m->core;
    *out = (machine_status){
        .cycles = core->now, .time_ps = now_ps(m), .instructions = m->count.instructions, .flash_stalls = m->count.flash_stalls,
        .clock_hz = m->device.clock.hz, .pc = pc_of(m, core->ip), .sp = core->r[13], .lowest_sp_main = m->count.lowest_sp[MAIN_STACK],
        .lowest_sp_process = m->count.lowest_sp[PROCESS_STACK], .resets_total = m->count.resets_total, .sleeping = core->sleeping,
        .in_handler = core->ipsr, .host_bytes = (uint32_t)inbox_count(m->device.host.inbox), .stop_kind = m->stop.kind,
        .stop_pc = m->stop.pc, .stop_address = m->stop.address, .stop_detail = m->stop.detail};
}

uint32_t emulator_read(machine *m, uint32_t address, uint8_t *out, uint32_t bytes) {
    const uint8_t *memory = bus_memory(m, address, bytes);
    if (memory) memcpy(out, memory, bytes);
    return memory != NULL;
}

uint32_t emulator_write(machine *m, uint32_t address, const uint8_t *in, uint32_t bytes) {
    uint8_t *memory = bus_memory(m, address, bytes);
    if (!memory) return 0;
    memcpy(memory, in, bytes);
    code_forget(m, address, bytes);
    return 1;
}

/* r0-r15, xPSR, PRIMASK, CONTROL, MSP, PSP: 21 words. */
void emulator_registers(machine *m, uint32_t *out) {
    memcpy(out, m->core.r, 15 * sizeof(uint32_t));
    out[15] = pc_of(m, m->core.ip);
    out[16] = flags_of(m) | m->core.ipsr;
    out[17] = m->core.primask, out[18] = m->core.control;
    bool process = m->core.control & 2u && !m->core.ipsr;
    out[19] = process ? m->core.other_sp : m->core.r[13];
    out[20] = process ? m->core.r[13] : m->core.other_sp;
}

/* r0-r15 and the flags of xPSR: 17 words. */
void emulator_set_registers(machine *m, const uint32_t *in) {
    memcpy(m->core.r, in, 15 * sizeof(uint32_t));
    m->core.r[13] &= ~3u;
    set_flags(m, in[16]);
    go_to(m, in[15] | 1u);
}

void emulator_break(machine *m, uint32_t address, uint32_t set) {
    op *entry = code_at(m, address);
    if (entry) entry->run = set ? op_host_break : address >= SRAM_BASE ? op_fetch_ram : op_predecode;
}

void emulator_execution_counts(machine *m, uint64_t *flash, uint64_t *sram) {
    const op *alias = code_at(m, 0), *own = code_at(m, FLASH_BASE), *ram = code_at(m, SRAM_BASE);
    for (uint32_t i = 0; i < FLASH_BYTES / 2; i++) flash[i] = (alias ? alias[i].count : 0) + own[i].count;
    for (uint32_t i = 0; i < SRAM_BYTES / 2; i++) sram[i] = ram[i].count;
}

void emulator_exception_counts(machine *m, uint64_t *out) { memcpy(out, m->count.exceptions, sizeof m->count.exceptions); }

uint32_t emulator_resets(machine *m, uint32_t *causes, uint64_t *times_ps) {
    uint32_t total = m->count.resets_total, kept = total < RESETS_KEPT ? total : RESETS_KEPT;
    for (uint32_t i = 0; i < kept; i++) {
        reset_record record = m->count.resets[(total - kept + i) % RESETS_KEPT];
        causes[i] = record.cause;
        times_ps[i] = record.time_ps;
    }
    return kept;
}

static line *line_of(machine *m, uint32_t to_host) { return to_host ? m->device.host.to_host : m->device.host.to_board; }

/* From now on: noise of this kind and no stuck level; the seed is not 0. */
void emulator_disturb(machine *m, uint32_t to_host, uint32_t bursts_per_2_32, uint32_t burst_bits, uint32_t seed) {
    line_of(m, to_host)->disturbed = (disturbance){.bursts_per_2_32 = bursts_per_2_32, .burst_bits = burst_bits, .random = seed};
}

void emulator_stick(machine *m, uint32_t to_host, uint32_t low) {
    line_stick(line_of(m, to_host), low, now_ps(m), m->device.host.bit_ps);
    usart_line_changed(m);
    host_listen(m);
}

void emulator_send(machine *m, const uint8_t *bytes, uint32_t count, uint64_t earliest_ps) {
    for (uint32_t i = 0; i < count; i++) host_send(m, bytes[i], earliest_ps);
}

uint64_t emulator_line_free_ps(machine *m) { return m->device.host.to_board->free_ps; }

uint32_t emulator_receive(machine *m, uint8_t *bytes, uint64_t *end_ps, uint8_t *errors, uint32_t most) {
    received_byte got;
    uint32_t count = 0;
    while (count < most && inbox_take(m->device.host.inbox, &got, 1)) {
        bytes[count] = got.byte, end_ps[count] = got.end_ps;
        errors[count++] = (uint8_t)(got.framing_error | got.noise << 1);
    }
    return count;
}

void emulator_set_analogue(machine *m, uint32_t channel, uint32_t code) { adc_set_code(m, channel, code); }

void emulator_silence_converter(machine *m) { adc_silence(m); }

void emulator_set_encoder(machine *m, uint32_t index, int64_t counts) { timer_set_encoder(m, index, counts); }

uint32_t emulator_timer_register(machine *m, uint32_t index, uint32_t word) {
    uint32_t value = 0;
    timer_read(m, index, 4 * word, &value);
    return value;
}

void emulator_gpio(machine *m, uint32_t port, uint32_t *mode, uint32_t *output) {
    *mode = m->device.gpio[port].reg[0];
    *output = m->device.gpio[port].reg[5];
}

void emulator_drive_pins(machine *m, uint32_t port, uint32_t mask, uint32_t levels) {
    m->device.gpio[port].input = (m->device.gpio[port].input & ~mask) | (levels & mask);
}
