/* A number of the law as the raw 32-bit word that crosses the line, and back. */
#ifndef WORDS_H
#define WORDS_H

#include <stdint.h>

#include "law.h"

typedef union {
    law_number number;
    uint32_t word;
} number_word;

static inline uint32_t word_of_number(law_number number)
{
    const number_word both = {.number = number};
    return both.word;
}

static inline law_number number_of_word(uint32_t word)
{
    const number_word both = {.word = word};
    return both.number;
}

#endif
