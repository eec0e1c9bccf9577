#include "bus.h"

#include <stddef.h>
#include <string.h>

#include "fault.h"
#include "peripherals.h"

#define SYSTEM_SPACE 0xE000E000u
#define SYSTEM_BYTES 0x1000u

uint8_t *bus_memory(machine *m, uint32_t address, uint32_t size) {
    if (address - SRAM_BASE < SRAM_BYTES) return size <= SRAM_BYTES - (address - SRAM_BASE) ? m->sram + (address - SRAM_BASE) : NULL;
    if (address < FLASH_BASE && m->device.system_memory_at_0) return NULL;
    uint32_t offset = address >= FLASH_BASE ? address - FLASH_BASE : address; /* flash is seen at 0 too */
    return offset < FLASH_BYTES && size <= FLASH_BYTES - offset ? m->flash + offset : NULL;
}

static bool refuse(machine *m, enum stop_kind kind, uint32_t address, uint32_t detail) {
    fault(m, kind, address, detail);
    return false;
}

/* A peripheral whose clock is off reads as zero and ignores writes; as that is never meant, it is a fault here. */
static bool clocked(machine *m, const block *place, uint32_t address, bool *answers) {
    *answers = place->enable == 0 || m->device.rcc.reg[place->enable] >> place->enable_bit & 1u;
    if (!*answers && m->stop_on_fault) return refuse(m, STOP_UNCLOCKED, address, 0);
    return true;
}

static bool read_word(machine *m, uint32_t address, uint32_t *word) {
    if (address - SYSTEM_SPACE < SYSTEM_BYTES) return system_read(m, address, word) || refuse(m, STOP_UNMAPPED, address, 0);
    const block *place = block_at(address);
    bool answers = false;
    if (!place) return refuse(m, STOP_UNMAPPED, address, 0);
    if (!clocked(m, place, address, &answers)) return false;
    *word = 0;
    return !answers || place->read(m, place->index, address - place->base, word) || refuse(m, STOP_UNMODELLED, address, 0);
}

static bool write_word(machine *m, uint32_t address, uint32_t word) {
    if (address - SYSTEM_SPACE < SYSTEM_BYTES) return system_write(m, address, word) || refuse(m, STOP_UNMAPPED, address, word);
    const block *place = block_at(address);
    bool answers = false;
    if (!place) return refuse(m, STOP_UNMAPPED, address, word);
    if (!clocked(m, place, address, &answers)) return false;
    return !answers || place->write(m, place->index, address - place->base, word) || refuse(m, STOP_UNMODELLED, address, word);
}

bool bus_read(machine *m, uint32_t address, uint32_t size, uint32_t *value) {
    if (address & (size - 1)) return refuse(m, STOP_UNALIGNED, address, size);
    const uint8_t *memory = bus_memory(m, address, size);
    if (memory) {
        if (address < SRAM_BASE) m->count.flash_stalls++;
        *value = 0;
        memcpy(value, memory, size);
        return true;
    }
    uint32_t word = 0, shift = 8 * (address & 3u);
    if (!read_word(m, address & ~3u, &word)) return false;
    *value = size == 4 ? word : (word >> shift) & ((1u << 8 * size) - 1u);
    return true;
}

/* Bytes and halfwords written to a peripheral are merged into its word: none of the registers modelled has a read side
 * effect on a word that is written in parts. */
bool bus_write(machine *m, uint32_t address, uint32_t size, uint32_t value) {
    if (address & (size - 1)) return refuse(m, STOP_UNALIGNED, address, size);
    if (address < FLASH_BASE + FLASH_BYTES && bus_memory(m, address, size)) return refuse(m, STOP_FLASH_WRITE, address, value);
    uint8_t *memory = bus_memory(m, address, size);
    if (memory) {
        memcpy(memory, &value, size);
        return true;
    }
    if (size == 4) return write_word(m, address, value);
    uint32_t word = 0, shift = 8 * (address & 3u), mask = ((1u << 8 * size) - 1u) << shift;
    if (!read_word(m, address & ~3u, &word)) return false;
    return write_word(m, address & ~3u, (word & ~mask) | (value << shift & mask));
}
