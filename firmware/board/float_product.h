/*
 * float_product.h - the product of two floats on a core without FPU; a part of float_routines.c, which says what holds for all of it.
 */
#ifndef FLOAT_PRODUCT_H
#define FLOAT_PRODUCT_H

/* Significand of a, a normal number, in two: upper 8 bits with the hidden one to r0, lower 16 to r4. */
#define HALVES_OF_A \
    "    uxth  r4, r0\n" \
    "    lsls  r0, r0, #9\n" \
    "    lsrs  r0, r0, #25\n" \
    "    adds  r0, #128\n"

/* Of b to r1 and r5. */
#define HALVES_OF_B \
    "    uxth  r5, r1\n" \
    "    lsls  r1, r1, #9\n" \
    "    lsrs  r1, r1, #25\n" \
    "    adds  r1, #128\n"

/* X, the product >> 16, to r0; r6 is low x low, whose lower half is below X. */
#define PRODUCT \
    "    movs  r6, r4\n" \
    "    muls  r6, r5, r6\n" \
    "    muls  r4, r1, r4\n" \
    "    muls  r5, r0, r5\n" \
    "    muls  r0, r1, r0\n" \
    "    adds  r4, r5\n" \
    "    lsls  r0, r0, #16\n" \
    "    adds  r0, r4\n" \
    "    lsrs  r1, r6, #16\n" \
    "    adds  r0, r1\n"

/* b in r3, doubled, r1 places below a normal number's, as one in r1; its sign in r5 and its exponent, by so much lower, to r2. */
#define NORMAL_B(lower) \
    "    subs  r5, r1\n" \
    "    adds  r2, r5\n" \
    "    subs  r2, #" lower "\n" \
    "    lsls  r3, r1\n" \
    "    lsrs  r1, r3, #1\n" \
    "    b     1b\n"

/*
 * The sign takes part in the sum of the exponents and comes out right: bit 8 of it is the exclusive or, bit 9 is shifted out.
 * The product of two 24-bit significands is that of their upper 8 and lower 16 bits; X is the product >> 16. E is the product's
 * exponent, less one, before normalisation. Where it is below 0, X >> (7 - E) counts least subnormals and so is the result's bits.
 */
__asm__(".syntax unified\n"
        ".section .text.float_routines, \"ax\", %progbits\n"
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
        "    bhi   10f\n" /* zero, subnormal, infinite, NaN */
        "    lsrs  r3, r1, #23\n"
        "    uxtb  r5, r3\n"
        "    subs  r5, #1\n"
        "    cmp   r5, #253\n"
        "    bhi   11f\n"
        "    adds  r4, r5\n"
        "    subs  r4, #126\n" /* E */
        "    cmp   r4, #252\n"
        "    bhi   30f\n"
        "    adds  r2, r3\n"
        "    subs  r2, #127\n"
        "1:\n"
        HALVES_OF_A
        HALVES_OF_B
        PRODUCT
        "    bmi   3f\n"
        "2:  lsls  r0, r0, #1\n"
        "    subs  r2, #1\n"
        "3:  lsls  r2, r2, #23\n"
        "    lsrs  r3, r0, #8\n" /* significand; carry = the half */
        "    bcc   5f\n"
        "    lsls  r0, r0, #25\n" /* all below the half */
        "    lsls  r6, r6, #16\n"
        "    orrs  r0, r6\n"
        "    bne   4f\n"
        "    lsrs  r0, r3, #1\n" /* tie: to even */
        "    bcc   5f\n"
        "4:  adds  r3, #1\n"
        "5:  adds  r0, r2, r3\n" /* the hidden one steps the exponent */
        "    pop   {r4, r5, r6}\n"
        "    bx    lr\n"
        /* an operand is no normal number: let r1 be it */
        "10: movs  r4, r0\n"
        "    movs  r0, r1\n"
        "    movs  r1, r4\n"
        "    lsrs  r2, r0, #23\n"
        "    uxtb  r4, r2\n"
        "    subs  r4, #1\n"
        "11: lsls  r3, r1, #1\n"
        "    beq   22f\n"
        "    lsrs  r5, r3, #24\n"
        "    bne   20f\n"
        /* subnormal; E with the least exponent, its own */
        "    subs  r4, #126\n"
        "    blt   34f\n"
        "    cmp   r4, #22\n"
        "    bls   32f\n"
        "    cmp   r4, #128\n"
        "    beq   21f\n"
        /* the product is normal: the leading one of b, at bit 16, 8 or 0 of r3 and above, comes to bit 23 of r1, and its exponent to r2 */
        "13: lsrs  r5, r1, #23\n" /* the sign, as b has no exponent */
        "    adr   r6, .Lplaces\n"
        "    lsrs  r1, r3, #8\n"
        "    beq   15f\n"
        "    lsrs  r4, r3, #16\n"
        "    bne   14f\n"
        "    ldrb  r1, [r6, r1]\n"
        "    lsls  r3, r3, #8\n"
        NORMAL_B("134")
        "14: ldrb  r1, [r6, r4]\n"
        NORMAL_B("126")
        "15: ldrb  r1, [r6, r3]\n"
        "    lsls  r3, r3, #16\n"
        NORMAL_B("142")
        /* E out of range */
        "30: cmp   r4, #253\n"
        "    bge   38f\n"
        "    eors  r2, r3\n"
        "    lsrs  r2, r2, #8\n"
        "    lsls  r2, r2, #31\n"
        "    movs  r3, #7\n"
        "    subs  r3, r4\n"
        HALVES_OF_A
        HALVES_OF_B
        "    b     35f\n"
        /* infinite or NaN */
        "20: lsls  r2, r1, #9\n"
        "    bne   24f\n"
        "    lsls  r2, r0, #1\n" /* infinity times zero is NaN */
        "    beq   24f\n"
        "    lsrs  r2, r2, #24\n"
        "    cmp   r2, #255\n"
        "    bne   25f\n"
        "21: lsls  r2, r0, #9\n"
        "    bne   24f\n"
        "    b     25f\n"
        /* zero */
        "22: lsls  r2, r0, #1\n"
        "    lsrs  r2, r2, #24\n"
        "    cmp   r2, #255\n"
        "    beq   24f\n"
        "    eors  r0, r1\n"
        "    lsrs  r0, r0, #31\n"
        "    lsls  r0, r0, #31\n"
        "    pop   {r4, r5, r6}\n"
        "    bx    lr\n"
        "24: movs  r0, #255\n"
        "    lsls  r0, r0, #1\n"
        "    adds  r0, #1\n"
        "    lsls  r0, r0, #22\n"
        "    pop   {r4, r5, r6}\n"
        "    bx    lr\n"
        "25: eors  r0, r1\n"
        "    lsrs  r0, r0, #31\n"
        "    lsls  r0, r0, #8\n"
        "    adds  r0, #255\n"
        "    lsls  r0, r0, #23\n"
        "    pop   {r4, r5, r6}\n"
        "    bx    lr\n"
        /* the product is subnormal, or of the least exponent; r3 is b without its sign, doubled */
        "34: uxth  r5, r1\n"
        "    eors  r1, r0\n"
        "    lsrs  r2, r1, #31\n"
        "    lsls  r2, r2, #31\n"
        "    lsrs  r1, r3, #17\n"
        "    movs  r3, #7\n"
        "    subs  r3, r4\n"
        "    b     33f\n"
        /* the factor of b that the exponent of a brings to E = 0; none where the product is larger */
        "32: movs  r5, #24\n"
        "    subs  r5, r4\n"
        "    movs  r6, r3\n"
        "    lsrs  r6, r5\n"
        "    bne   13b\n"
        "    lsls  r3, r4\n"
        "    eors  r1, r0\n"
        "    lsrs  r2, r1, #31\n"
        "    lsls  r2, r2, #31\n"
        "    lsrs  r1, r3, #1\n"
        "    uxth  r5, r1\n"
        "    lsrs  r1, r3, #17\n"
        "    movs  r3, #7\n"
        "33:\n"
        HALVES_OF_A
        "35:\n"
        PRODUCT
        "    movs  r1, r0\n"
        "    lsrs  r0, r3\n"
        "    movs  r4, #32\n"
        "    subs  r4, r3\n" /* below 0 nothing is left of X, nor of what falls off below */
        "    lsls  r1, r4\n"
        "    adds  r0, r2\n"
        "    lsls  r1, r1, #1\n" /* carry = the half */
        "    bcc   37f\n"
        "    lsls  r6, r6, #16\n"
        "    orrs  r1, r6\n"
        "    bne   36f\n"
        "    lsrs  r1, r0, #1\n" /* tie: to even */
        "    bcc   37f\n"
        "36: adds  r0, #1\n"
        "37: pop   {r4, r5, r6}\n"
        "    bx    lr\n"
        "38: bgt   25b\n"
        /* E = 253: the largest exponent there is, or infinite */
        "    movs  r2, r0\n"
        "    eors  r2, r1\n"
        "    lsrs  r2, r2, #31\n"
        "    lsls  r2, r2, #31\n"
        HALVES_OF_A
        HALVES_OF_B
        PRODUCT
        "    movs  r1, #0\n"
        "    cmp   r0, #0\n"
        "    bmi   39f\n"
        "    lsrs  r2, r2, #23\n"
        "    adds  r2, #254\n"
        "    b     2b\n"
        "39: movs  r0, r2\n"
        "    b     25b\n"
        ".size __aeabi_fmul, . - __aeabi_fmul\n");

#endif
