/*
 * float_sum.h - sum and difference of two floats on a core without FPU; a part of float_routines.c, which says what holds for all of it.
 */
#ifndef FLOAT_SUM_H
#define FLOAT_SUM_H

/* The smaller significand from its fraction in the upper bits of r4. */
#define HIDDEN_ONE \
    "    lsrs  r4, r4, #9\n" \
    "    movs  r5, #1\n" \
    "    lsls  r5, r5, #23\n" \
    "    orrs  r4, r5\n"

/* It moves in line with the larger one, whose fraction r3 becomes; r5 what fell off, a fraction of an ulp with the half at bit 31. */
#define ALIGNED \
    "    movs  r5, r4\n" \
    "    lsrs  r4, r3\n" \
    "    subs  r3, #32\n" \
    "    rsbs  r3, r3, #0\n" \
    "    lsls  r5, r3\n" \
    "    lsls  r3, r0, #9\n" \
    "    lsrs  r3, r3, #9\n"

/*
 * The end of a sum that cancelled, with nothing to round: r4 places bring the leading one past bit 31, where it is implied,
 * and lower the exponent as much. Written out three times: a jump here would be on the dearest path.
 */
#define EXACT \
    "    cmp   r2, r4\n" \
    "    bls   19f\n" \
    "    lsls  r3, r4\n" \
    "    lsrs  r3, r3, #9\n" \
    "    lsrs  r0, r0, #23\n" \
    "    subs  r0, r4\n" \
    "    lsls  r0, r0, #23\n" \
    "    adds  r0, r3\n" \
    "    pop   {r4, r5}\n" \
    "    bx    lr\n"

/*
 * r0 becomes the operand of larger magnitude, r1 the other, then whether signs differ; r2 the exponent, r3 the distance
 * to the other one. Nothing is left of the smaller one from 24 places on, nor of what fell off from 33 on.
 */
__asm__(".syntax unified\n"
        ".section .text.float_routines, \"ax\", %progbits\n"
        ".global __aeabi_fsub\n"
        ".type __aeabi_fsub, %function\n"
        ".p2align 2\n"
        ".thumb_func\n"
        "__aeabi_fsub:\n"
        "    movs  r2, #1\n"
        "    lsls  r2, r2, #31\n"
        "    eors  r1, r2\n" /* and on into the sum */
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
        "    movs  r4, r0\n"
        "    movs  r0, r1\n"
        "    movs  r1, r4\n"
        "    lsls  r2, r0, #1\n"
        "    lsls  r3, r1, #1\n"
        "1:  lsrs  r2, r2, #24\n"
        "    cmp   r2, #255\n"
        "    beq   22f\n"
        "    lsrs  r3, r3, #24\n"
        "    beq   20f\n"
        "    subs  r3, r2, r3\n"
        "    lsls  r4, r1, #9\n"
        "    eors  r1, r0\n"
        "    bmi   10f\n"
        /* same sign */
        HIDDEN_ONE
        "2:\n"
        ALIGNED
        "    adds  r0, r4\n"
        "    adds  r3, r4\n"
        "    lsrs  r1, r3, #23\n"
        "    bne   6f\n"
        "3:  lsls  r5, r5, #1\n" /* carry = the half */
        "    bcc   5f\n"
        "    bne   4f\n"
        "    lsrs  r3, r0, #1\n" /* tie: to even */
        "    bcc   5f\n"
        "4:  adds  r0, #1\n"
        "5:  pop   {r4, r5}\n"
        "    bx    lr\n"
        /* the sum has 25 bits: halve it under its sign and exponent */
        "6:  subs  r0, r3\n"
        "    cmp   r2, #254\n"
        "    beq   9f\n"
        "    movs  r1, #1\n"
        "    lsls  r1, r1, #22\n"
        "    adds  r0, r1\n"
        "    cmp   r5, #0\n"
        "    beq   7f\n"
        "    lsrs  r3, r3, #1\n" /* carry = the half */
        "    adcs  r0, r3\n"
        "    pop   {r4, r5}\n"
        "    bx    lr\n"
        "7:  lsrs  r3, r3, #1\n"
        "    bcc   8f\n"
        "    adcs  r0, r3\n" /* tie: to even, from one above where that is odd */
        "    lsrs  r0, r0, #1\n"
        "    lsls  r0, r0, #1\n"
        "    pop   {r4, r5}\n"
        "    bx    lr\n"
        "8:  adds  r0, r3\n"
        "    pop   {r4, r5}\n"
        "    bx    lr\n"
        /* infinite */
        "9:  lsrs  r0, r0, #31\n"
        "    lsls  r0, r0, #8\n"
        "    adds  r0, #255\n"
        "    lsls  r0, r0, #23\n"
        "    b     5b\n"
        /* the smaller one is zero, or subnormal: then its exponent is 1 and it has no hidden one */
        "20: lsls  r4, r1, #1\n"
        "    beq   21f\n"
        "    subs  r3, r2, #1\n"
        "    blt   24f\n"
        "    lsrs  r4, r4, #1\n"
        "    eors  r1, r0\n"
        "    bpl   2b\n"
        "    cmp   r3, #0\n"
        "    bne   11f\n"
        "    subs  r0, r4\n" /* of two with exponent 1 the bits count */
        "    b     5b\n"
        "21: cmp   r2, #0\n"
        "    bne   5b\n"
        "    lsls  r2, r0, #1\n"
        "    bne   5b\n"
        "    ands  r0, r1\n" /* both are zero */
        "    b     5b\n"
        /* both are subnormal: their bits count */
        "24: lsrs  r4, r4, #1\n"
        "    eors  r1, r0\n"
        "    bmi   25f\n"
        "    adds  r0, r4\n"
        "    b     5b\n"
        "25: subs  r0, r4\n"
        "    lsls  r4, r0, #1\n"
        "    bne   5b\n"
        "    movs  r0, #0\n"
        "    b     5b\n"
        /* the larger one is infinite or NaN */
        "22: lsls  r2, r0, #9\n"
        "    bne   26f\n"
        "    lsrs  r3, r3, #24\n"
        "    cmp   r3, #255\n"
        "    bne   5b\n"
        "    eors  r1, r0\n"
        "    bpl   5b\n"
        "26: movs  r0, #255\n"
        "    lsls  r0, r0, #1\n"
        "    adds  r0, #1\n"
        "    lsls  r0, r0, #22\n"
        "    b     5b\n"
        /* opposite sign, at least two places apart: at most one place is lost */
        "10: cmp   r3, #1\n"
        "    bls   12f\n"
        HIDDEN_ONE
        "11:\n"
        ALIGNED
        "    rsbs  r5, r5, #0\n"
        "    sbcs  r3, r4\n"
        "    bcs   1f\n"
        "    adds  r5, r5\n"
        "    adcs  r3, r3\n"
        "1:  lsrs  r0, r0, #23\n"
        "    lsls  r0, r0, #23\n"
        "    adds  r0, r3\n" /* below 0 it takes one from the exponent */
        "    b     3b\n"
        /* one place apart or none: r3 becomes the difference with the bit below the hidden one at bit 31, and is exact */
        "12: bne   16f\n"
        "    lsls  r3, r0, #9\n"
        "    lsrs  r4, r4, #1\n"
        "    subs  r3, r3, r4\n" /* less a half, which is the difference of the hidden ones */
        "    bcs   17f\n"
        "    lsls  r3, r3, #1\n"
        "    lsrs  r3, r3, #1\n"
        "13: adr   r1, .Lplaces\n"
        "    lsrs  r4, r3, #16\n"
        "    beq   15f\n"
        "    lsrs  r4, r4, #8\n"
        "    bne   14f\n"
        "    lsrs  r4, r3, #16\n"
        "    ldrb  r4, [r1, r4]\n"
        "    adds  r4, #8\n"
        EXACT
        "14: ldrb  r4, [r1, r4]\n"
        EXACT
        "15: lsrs  r4, r3, #8\n"
        "    ldrb  r4, [r1, r4]\n"
        "    adds  r4, #16\n"
        EXACT
        "16: lsls  r3, r0, #9\n"
        "    subs  r3, r3, r4\n"
        "    bne   13b\n"
        "    movs  r0, #0\n"
        "    pop   {r4, r5}\n"
        "    bx    lr\n"
        "17: lsrs  r0, r0, #23\n"
        "    lsls  r1, r3, #1\n"
        "    bcs   18f\n"
        "    subs  r0, #1\n" /* one place lost */
        "    lsls  r0, r0, #23\n"
        "    lsrs  r3, r3, #8\n"
        "    adds  r0, r3\n"
        "    pop   {r4, r5}\n"
        "    bx    lr\n"
        "18: lsls  r0, r0, #23\n"
        "    lsrs  r3, r1, #9\n"
        "    b     7b\n"
        "19: subs  r2, #1\n" /* subnormal */
        "    lsls  r3, r2\n"
        "    lsrs  r3, r3, #9\n"
        "    lsrs  r0, r0, #31\n"
        "    lsls  r0, r0, #31\n"
        "    adds  r0, r3\n"
        "    pop   {r4, r5}\n"
        "    bx    lr\n"
        ".size __aeabi_fadd, . - __aeabi_fadd\n");

#endif
