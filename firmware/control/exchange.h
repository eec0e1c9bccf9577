/*
 * What a board and the control path hand to one another. It knows neither law nor table, so the chip's files do not either.
 */
#ifndef EXCHANGE_H
#define EXCHANGE_H

#include <stdint.h>

#include "encoder_watch.h"
#include "supervisor.h"

/* What the board knows of itself at the start. */
typedef struct {
    uint8_t unique_id[12];
    uint8_t reset_cause; /* PROTOCOL_RESET_CAUSE_... */
    uint32_t resets;     /* since power on */
} board_identity;

/* Faults that the board layer counts. */
typedef struct {
    uint32_t uart_overruns;
    uint32_t uart_framing_errors;
    uint32_t uart_noise_errors;
    uint32_t rx_ring_overflows;
    uint32_t tx_frames_dropped;
    uint32_t tick_overruns;
} board_faults;

#endif
