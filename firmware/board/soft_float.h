/*
 * soft_float.h - sum, difference and product of IEEE 754 binary32 numbers, given and returned as bits.
 *
 * Plain C for every operand; on the target float_routines.c deals with the common ones before it comes to these.
 */
#ifndef SOFT_FLOAT_H
#define SOFT_FLOAT_H

#include <stdint.h>

uint32_t soft_float_sum(uint32_t a, uint32_t b);
uint32_t soft_float_product(uint32_t a, uint32_t b);

#endif
