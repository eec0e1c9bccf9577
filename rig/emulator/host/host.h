/* The functions that Python calls. native.py gives this very file to cffi: only plain declarations here. */
#ifndef HOST_H
#define HOST_H

#include "machine.h"

/* What the host wants to know between two runs. */
typedef struct {
    uint64_t cycles, time_ps, instructions, flash_stalls, clock_hz;
    uint32_t pc, sp, lowest_sp_main, lowest_sp_process, resets_total, sleeping, in_handler, host_bytes;
    uint32_t stop_kind, stop_pc, stop_address, stop_detail;
} machine_status;

typedef struct { uint32_t result, stop_kind, stack_bytes, padding; uint64_t cycles, instructions, flash_stalls; } call_report;

/* One block of target memory that is copied at every step of a batch: step k uses `host + k * bytes`. */
typedef struct { uint32_t address, bytes; uint8_t *host; } call_block;

machine *emulator_create(const uint8_t *flash, uint32_t bytes, const uint32_t *unique_id);
void emulator_destroy(machine *m);
void emulator_configure(machine *m, uint32_t stop_on_fault, uint32_t stop_on_reset, uint32_t stack_limit, uint64_t host_bit_ps);
void emulator_set_host_bit(machine *m, uint64_t bit_ps);
void emulator_reset(machine *m, uint32_t cause);
void emulator_boot_loader_leaves(machine *m, uint32_t flash_offset);
void emulator_run(machine *m, uint64_t limit_cycle, uint64_t limit_ps, uint64_t host_bytes);
void emulator_status(machine *m, machine_status *out);

uint32_t emulator_read(machine *m, uint32_t address, uint8_t *out, uint32_t bytes);
uint32_t emulator_write(machine *m, uint32_t address, const uint8_t *in, uint32_t bytes);
void emulator_registers(machine *m, uint32_t *out);
void emulator_set_registers(machine *m, const uint32_t *in);
void emulator_break(machine *m, uint32_t address, uint32_t set);
void emulator_execution_counts(machine *m, uint64_t *flash, uint64_t *sram);
void emulator_exception_counts(machine *m, uint64_t *out);
uint32_t emulator_resets(machine *m, uint32_t *causes, uint64_t *times_ps);

/* `arguments` are eight words, of which `stacked` go behind the four in registers. */
void emulator_call(machine *m, uint32_t address, const uint32_t *arguments, uint32_t stacked, uint64_t max_cycles, call_report *out);
uint32_t emulator_call_many(machine *m, uint32_t address, const uint32_t *arguments, uint64_t max_cycles, uint32_t steps,
                            const call_block *inputs, uint32_t input_count, const call_block *outputs, uint32_t output_count,
                            uint32_t *results, uint64_t *cycles, call_report *last);

void emulator_disturb(machine *m, uint32_t to_host, uint32_t bursts_per_2_32, uint32_t burst_bits, uint32_t seed);
void emulator_stick(machine *m, uint32_t to_host, uint32_t low);
void emulator_send(machine *m, const uint8_t *bytes, uint32_t count, uint64_t earliest_ps);
uint64_t emulator_line_free_ps(machine *m);
uint32_t emulator_receive(machine *m, uint8_t *bytes, uint64_t *end_ps, uint8_t *errors, uint32_t most);
void emulator_set_analogue(machine *m, uint32_t channel, uint32_t code);
void emulator_silence_converter(machine *m);
void emulator_set_encoder(machine *m, uint32_t index, int64_t counts);
uint32_t emulator_timer_register(machine *m, uint32_t index, uint32_t word);
void emulator_gpio(machine *m, uint32_t port, uint32_t *mode, uint32_t *output);
void emulator_drive_pins(machine *m, uint32_t port, uint32_t mask, uint32_t levels);

#endif
