#include "board.h"
#include "protocol.h"
#include "chip.h"

/* Kept over a reset; the section is not cleared at start-up. */
__attribute__((section(".noinit"))) static uint32_t resets_since_power_on;

static uint8_t cause_of(uint32_t flags)
{
    /* Every reset also pulls the pin low, so the pin is the last one asked. */
    if ((flags & RCC_CSR_PWRRSTF) != 0u) {
        return PROTOCOL_RESET_CAUSE_POWER;
    }
    if ((flags & RCC_CSR_IWDGRSTF) != 0u) {
        return PROTOCOL_RESET_CAUSE_WATCHDOG;
    }
    if ((flags & RCC_CSR_SFTRSTF) != 0u) {
        return PROTOCOL_RESET_CAUSE_SOFTWARE;
    }
    return (flags & RCC_CSR_PINRSTF) != 0u ? PROTOCOL_RESET_CAUSE_PIN : PROTOCOL_RESET_CAUSE_OTHER;
}

board_identity board_identify(void)
{
    board_identity identity = {.reset_cause = cause_of(RCC->CSR)};
    RCC->CSR |= RCC_CSR_RMVF;
    resets_since_power_on =
        identity.reset_cause == PROTOCOL_RESET_CAUSE_POWER ? 0u : resets_since_power_on + 1u;
    identity.resets = resets_since_power_on;
    for (uint32_t i = 0; i < sizeof identity.unique_id; i++) {
        identity.unique_id[i] = (uint8_t)((UNIQUE_ID[i >> 2] >> (8u * (i & 3u))) & 0xffu);
    }
    return identity;
}
