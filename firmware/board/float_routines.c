/*
 * float_routines.c - the routines that the compiler calls for + - * of floats on a core without FPU, written for its cycles.
 *
 * Run-time ABI for the Arm Architecture, 4.1.2. Normal numbers and zeros are dealt with here; subnormals, infinities, NaN and
 * products out of range go on to soft_float.c, which is plain C and says what all of this computes. Both are exact IEEE 754, so
 * that target and host agree in every bit. Only r0..r3, r12 and the flags may change.
 */
#include "soft_float.h"

#ifdef __ARM_ARCH_6M__

uint32_t __aeabi_fadd(uint32_t a, uint32_t b);
uint32_t __aeabi_fsub(uint32_t a, uint32_t b);
uint32_t __aeabi_fmul(uint32_t a, uint32_t b);

/*
 * The sign takes part in the sum of the exponents and comes out right: bit 8 of it is the exclusive or, bit 9 is shifted out.
 * The product of two 24-bit significands is that of their upper 8 and lower 16 bits; X is the product >> 16.
 */
__asm__(".syntax unified\n"
        ".section .text.__aeabi_fmul, \"ax\", %progbits\n"
        ".global __aeabi_fmul\n"
        ".type __aeabi_fmul, %function\n"
        ".p2align 2\n"
        ".thumb_func\n"
        "__aeabi_fmul:\n"
        "    push  {r4, r5, r6}\n"
        "    lsrs  r2, r0, #23\n" /* sign and exponent of a */
        "    uxtb  r4, r2\n"
        "    subs  r4, #1\n"
        "    cmp   r4, #253\n"
        "    bhi   3f\n" /* zero, subnormal, infinite, NaN */
        "    lsrs  r3, r1, #23\n"
        "    uxtb  r5, r3\n"
        "    subs  r5, #1\n"
        "    cmp   r5, #253\n"
        "    bhi   3f\n"
        "    adds  r4, r5\n"
        "    subs  r4, #126\n"
        "    cmp   r4, #252\n" /* exponent of the product, less one, before normalisation */
        "    bhi   3f\n"
        "    adds  r2, r3\n"
        "    subs  r2, #127\n"
        "    uxth  r4, r0\n"
        "    lsls  r0, r0, #9\n"
        "    lsrs  r0, r0, #25\n"
        "    adds  r0, #128\n" /* upper 8 bits of a with the hidden one */
        "    uxth  r5, r1\n"
        "    lsls  r1, r1, #9\n"
        "    lsrs  r1, r1, #25\n"
        "    adds  r1, #128\n"
        "    movs  r6, r4\n"
        "    muls  r6, r5, r6\n" /* low x low */
        "    muls  r4, r1, r4\n"
        "    muls  r5, r0, r5\n"
        "    muls  r0, r1, r0\n" /* high x high */
        "    adds  r4, r5\n"
        "    lsls  r0, r0, #16\n"
        "    adds  r0, r4\n"
        "    lsrs  r1, r6, #16\n"
        "    adds  r0, r1\n" /* X */
        "    bmi   1f\n"
        "    lsls  r0, r0, #1\n"
        "    subs  r2, #1\n"
        "1:  lsls  r2, r2, #23\n"
        "    lsrs  r3, r0, #8\n" /* significand; carry = the half */
        "    bcc   2f\n"
        "    lsls  r0, r0, #25\n" /* all below the half */
        "    lsls  r6, r6, #16\n"
        "    orrs  r0, r6\n"
        "    bne   4f\n"
        "    lsrs  r0, r3, #1\n" /* tie: to even */
        "    bcc   2f\n"
        "4:  adds  r3, #1\n"
        "2:  adds  r0, r2, r3\n" /* the hidden one steps the exponent */
        "    pop   {r4, r5, r6}\n"
        "    bx    lr\n"
        "3:  pop   {r4, r5, r6}\n"
        "    lsls  r2, r0, #1\n"
        "    lsls  r3, r1, #1\n"
        "    cmp   r2, #0\n"
        "    beq   6f\n"
        "    cmp   r3, #0\n"
        "    bne   7f\n"
        "6:  orrs  r2, r3\n" /* one is zero, this is the other */
        "    lsrs  r2, r2, #24\n"
        "    cmp   r2, #255\n"
        "    beq   7f\n"
        "    eors  r0, r1\n"
        "    lsrs  r0, r0, #31\n"
        "    lsls  r0, r0, #31\n"
        "    bx    lr\n"
        "7:  ldr   r2, 5f\n"
        "    bx    r2\n"
        "    .p2align 2\n"
        "5:  .word soft_float_product\n"
        ".size __aeabi_fmul, . - __aeabi_fmul\n");

/*
 * r0 becomes the operand of larger magnitude, r1 the other; r4 its significand moved in line, r5 what fell off below,
 * a fraction of an ulp with the half at bit 31. Further apart than 25 places the smaller one cannot count.
 */
__asm__(".section .text.__aeabi_fadd, \"ax\", %progbits\n"
        ".global __aeabi_fsub\n"
        ".type __aeabi_fsub, %function\n"
        ".p2align 2\n"
        ".thumb_func\n"
        "__aeabi_fsub:\n"
        "    movs  r2, #1\n"
        "    lsls  r2, r2, #31\n"
        "    eors  r1, r2\n"
        "    b     __aeabi_fadd\n"
        ".size __aeabi_fsub, . - __aeabi_fsub\n"
        ".global __aeabi_fadd\n"
        ".type __aeabi_fadd, %function\n"
        ".thumb_func\n"
        "__aeabi_fadd:\n"
        "    push  {r4, r5}\n"
        "    lsls  r2, r0, #1\n"
        "    lsls  r3, r1, #1\n"
        "    cmp   r2, r3\n"
        "    bhs   1f\n"
        "    movs  r4, r2\n"
        "    movs  r2, r3\n"
        "    movs  r3, r4\n"
        "    movs  r4, r0\n"
        "    movs  r0, r1\n"
        "    movs  r1, r4\n"
        "1:  lsrs  r2, r2, #24\n" /* exponent */
        "    cmp   r2, #254\n"
        "    bhs   7f\n" /* infinite, NaN, or about to overflow */
        "    lsrs  r3, r3, #24\n"
        "    beq   6f\n"
        "    subs  r3, r2, r3\n" /* distance */
        "    cmp   r3, #25\n"
        "    bhi   3f\n"
        "    lsls  r4, r1, #9\n"
        "    lsrs  r4, r4, #9\n"
        "    movs  r5, #1\n"
        "    lsls  r5, r5, #23\n"
        "    orrs  r4, r5\n"
        "    movs  r5, r4\n"
        "    lsrs  r4, r3\n"
        "    subs  r3, #32\n"
        "    rsbs  r3, r3, #0\n"
        "    lsls  r5, r3\n"
        "    lsls  r3, r0, #9\n"
        "    lsrs  r3, r3, #9\n" /* fraction of the larger */
        "    eors  r1, r0\n"
        "    bmi   4f\n"
        /* same sign */
        "    adds  r0, r4\n"
        "    adds  r3, r4\n"
        "    lsrs  r1, r3, #23\n"
        "    bne   8f\n"
        "2:  lsls  r5, r5, #1\n" /* carry = the half */
        "    bcc   3f\n"
        "    bne   9f\n"
        "    lsrs  r3, r0, #1\n" /* tie: to even */
        "    bcc   3f\n"
        "9:  adds  r0, #1\n"
        "3:  pop   {r4, r5}\n"
        "    bx    lr\n"
        /* the sum has 25 bits: halve it under its sign and exponent */
        "8:  subs  r0, r3\n"
        "    movs  r1, #1\n"
        "    lsls  r1, r1, #22\n"
        "    adds  r0, r1\n"
        "    lsrs  r3, r3, #1\n" /* carry = the half */
        "    mov   r12, r3\n"
        "    add   r0, r12\n"
        "    bcc   3b\n"
        "    cmp   r5, #0\n"
        "    bne   9b\n"
        "    lsrs  r3, r0, #1\n"
        "    bcs   9b\n"
        "    pop   {r4, r5}\n"
        "    bx    lr\n"
        /* opposite sign */
        "4:  rsbs  r5, r5, #0\n"
        "    sbcs  r3, r4\n"
        "    bcc   5f\n"
        "    lsrs  r0, r0, #23\n"
        "    lsls  r0, r0, #23\n"
        "    adds  r0, r3\n"
        "    b     2b\n"
        /* cancellation: up by one place; if that is not enough the rest is empty and the result exact */
        "5:  movs  r1, #1\n"
        "    lsls  r1, r1, #23\n"
        "    adds  r3, r1\n"
        "    subs  r2, #2\n" /* exponent less one, after the first place */
        "    adds  r5, r5\n"
        "    adcs  r3, r3\n"
        "    beq   12f\n"
        "    lsrs  r4, r3, #8\n"
        "    bne   10f\n"
        "    lsls  r3, r3, #16\n"
        "    subs  r2, #16\n"
        "10: lsrs  r4, r3, #16\n"
        "    bne   11f\n"
        "    lsls  r3, r3, #8\n"
        "    subs  r2, #8\n"
        "11: lsrs  r4, r3, #20\n"
        "    bne   13f\n"
        "    lsls  r3, r3, #4\n"
        "    subs  r2, #4\n"
        "13: lsrs  r4, r3, #22\n"
        "    bne   16f\n"
        "    lsls  r3, r3, #2\n"
        "    subs  r2, #2\n"
        "16: lsrs  r4, r3, #23\n"
        "    bne   17f\n"
        "    lsls  r3, r3, #1\n"
        "    subs  r2, #1\n"
        "17: lsrs  r0, r0, #31\n"
        "    lsls  r0, r0, #31\n"
        "    cmp   r2, #0\n"
        "    blt   14f\n"
        "    adds  r0, r3\n"
        "    lsls  r2, r2, #23\n"
        "    adds  r0, r2\n"
        "    b     2b\n"
        "12: movs  r0, #0\n"
        "    b     3b\n"
        "14: rsbs  r2, r2, #0\n" /* subnormal, exact */
        "    lsrs  r3, r2\n"
        "    adds  r0, r3\n"
        "    b     3b\n"
        /* the smaller one is zero or subnormal */
        "6:  lsls  r3, r1, #1\n"
        "    bne   7f\n"
        "    cmp   r2, #0\n"
        "    bne   3b\n"
        "7:  pop   {r4, r5}\n"
        "    ldr   r2, 15f\n"
        "    bx    r2\n"
        "    .p2align 2\n"
        "15: .word soft_float_sum\n"
        ".size __aeabi_fadd, . - __aeabi_fadd\n");

#endif
