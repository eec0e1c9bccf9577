/* A plain fuzzer where libFuzzer is absent: so many seeded inputs, each made anew or mutated from an earlier one. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROOM 512u
#define KEPT 256u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint32_t state = 2463534242u;

static uint32_t random_below(uint32_t limit)
{
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state % limit;
}

typedef struct {
    uint8_t bytes[ROOM];
    size_t size;
} input;

static void make(input *self)
{
    self->size = 1u + random_below(ROOM);
    for (size_t i = 0; i < self->size; i++) {
        self->bytes[i] = (uint8_t)random_below(256);
    }
}

static void mutate(input *self, const input *other)
{
    for (uint32_t i = 1u + random_below(4); i > 0u; i--) {
        self->bytes[random_below((uint32_t)self->size)] = (uint8_t)random_below(256);
    }
    const size_t at = random_below((uint32_t)(self->size < other->size ? self->size : other->size));
    if (random_below(2) == 0u) {
        memcpy(self->bytes + at, other->bytes + at, other->size - at);
        self->size = other->size;
    }
}

int main(int count, char **arguments)
{
    static input kept[KEPT];
    const long runs = count > 1 ? atol(arguments[1]) : 100000;
    for (uint32_t i = 0; i < KEPT; i++) {
        make(&kept[i]);
    }
    for (long run = 0; run < runs; run++) {
        input *one = &kept[random_below(KEPT)];
        if (random_below(8) == 0u) {
            make(one);
        } else {
            mutate(one, &kept[random_below(KEPT)]);
        }
        (void)LLVMFuzzerTestOneInput(one->bytes, one->size);
    }
    printf("%ld inputs\n", runs);
    return 0;
}
