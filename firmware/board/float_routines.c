/*
 * float_routines.c - the routines that the compiler calls for + - * of floats on a core without FPU, written for its cycles.
 *
 * Run-time ABI for the Arm Architecture, 4.1.2: IEEE 754 binary32, to nearest even, subnormals included, bit for bit what the
 * host computes; every NaN result is the quiet 0x7FC00000. No operands take much longer than ordinary ones, as the law's time
 * is bounded by the longest. Only r0..r3, r12 and the flags may change.
 */
#ifdef __ARM_ARCH_6M__

#include <stdint.h>

uint32_t __aeabi_fadd(uint32_t a, uint32_t b);
uint32_t __aeabi_fsub(uint32_t a, uint32_t b);
uint32_t __aeabi_fmul(uint32_t a, uint32_t b);

/* One section of both and of the table that they reach by its distance from themselves. */
#include "float_product.h"
#include "float_sum.h"

/* By a byte: the places that bring its leading one past bit 7. */
__asm__(".syntax unified\n"
        ".section .text.float_routines, \"ax\", %progbits\n"
        ".p2align 2\n"
        ".Lplaces:\n"
        ".byte 9\n"
        ".byte 8\n"
        ".fill 2, 1, 7\n"
        ".fill 4, 1, 6\n"
        ".fill 8, 1, 5\n"
        ".fill 16, 1, 4\n"
        ".fill 32, 1, 3\n"
        ".fill 64, 1, 2\n"
        ".fill 128, 1, 1\n");

#endif
