/* Predecoded code: which instruction stands where. */
#ifndef CODE_H
#define CODE_H

#include "handler.h"

bool code_create(machine *m);
void code_destroy(machine *m);

/* Forget what was decoded of these bytes, because the host has changed them. */
void code_forget(machine *m, uint32_t address, uint32_t bytes);

/* The entry of a halfword address, NULL outside all code regions. */
op *code_at(machine *m, uint32_t address);

/* Address of a predecoded instruction. */
uint32_t pc_of(const machine *m, const op *ip);

/* Continue at `target`, whose bit 0 must say Thumb. */
void go_to(machine *m, uint32_t target);

/* Fill in `entry` for the instruction at its place; returns the function that executes it. */
handler decode(machine *m, op *entry);

#endif
