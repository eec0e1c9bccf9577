/* What a freestanding compiler may call; built with -fno-builtin so that the loops do not become calls to themselves. */
#include <stddef.h>
#include <stdint.h>

void *memcpy(void *restrict to, const void *restrict from, size_t count);
void *memset(void *to, int value, size_t count);

static int aligned(uintptr_t address)
{
    return (address & 3u) == 0u;
}

void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    uint8_t *target = to;
    const uint8_t *source = from;
    if (aligned((uintptr_t)to) && aligned((uintptr_t)from)) {
        for (; count >= 4u; count -= 4u, target += 4, source += 4) {
            *(uint32_t *)(void *)target = *(const uint32_t *)(const void *)source;
        }
    }
    while (count-- > 0u) {
        *target++ = *source++;
    }
    return to;
}

void *memset(void *to, int value, size_t count)
{
    uint8_t *target = to;
    while (count-- > 0u) {
        *target++ = (uint8_t)value;
    }
    return to;
}
