/* State of the peripherals: plain data, so that a host call can put it aside and restore it. */
#ifndef DEVICES_H
#define DEVICES_H

#include <stdbool.h>
#include <stdint.h>

#include "inbox.h"
#include "line.h"

#define RESETS_KEPT 64u

/* Everything that can make something happen at a time of its own. */
enum device { DEV_SYSTICK, DEV_TIM1, DEV_TIM2, DEV_TIM3, DEV_TIM6, DEV_TIM7, DEV_USART_TX, DEV_USART_RX, DEV_HOST_RX, DEV_IWDG, DEVICES };

/* Causes of a reset as RCC_CSR shows them (RM0444 5.4.24). */
enum reset_cause {
    RESET_PIN = 1u << 26, RESET_POWER = 1u << 27, RESET_SOFTWARE = 1u << 28, RESET_WATCHDOG = 1u << 29
};
typedef struct { uint32_t cause; uint64_t time_ps; } reset_record;

/* Core clock: `hz` since `base_cycle`, which was at `base_ps`. */
typedef struct { uint64_t hz, base_cycle, base_ps; uint32_t apb_divider, timer_divider; } clock_state;

typedef struct { uint32_t csr, rvr; uint64_t base_cycle; uint32_t base_value; } systick_state;

/* RM0444 5.4: registers by word offset. */
typedef struct { uint32_t reg[25]; } rcc_state;

typedef struct { uint32_t reg[11]; uint32_t input; } gpio_state;

/* A timer of any width; registers by word offset as in RM0444 22.4. `counter` was true at `base_cycle`. */
typedef struct {
    uint32_t reg[27];
    uint32_t counter, prescaler, reload; /* the values in force; PSC and a preloaded ARR follow at the update event */
    uint64_t base_cycle;
    int64_t host_counts;
} timer_state;

typedef struct {
    uint32_t cr1, cr2, cr3, brr, presc, isr, rdr, tdr;
    bool shifting;
    receiver rx;
} usart_state;

typedef struct { uint32_t pr, rlr, from, winr; bool unlocked, running; uint64_t reload_ps, busy_until_ps; uint32_t busy; } iwdg_state;

#define ADC_CHANNELS 19u

/* RM0444 15.12: registers by word offset, up to DR. A conversion, or a calibration, ends at cycle `due` with the code `taken`. */
typedef struct {
    uint32_t reg[17], code[ADC_CHANNELS], taken;
    uint64_t powered, calibrated, due;
    bool silent;
} adc_state;

/* The other end of the serial line, at its own bit length. */
typedef struct { line *to_board, *to_host; inbox *inbox; receiver rx; uint64_t bit_ps; } host_side;

typedef struct {
    uint64_t due[DEVICES];
    clock_state clock;
    systick_state systick;
    rcc_state rcc;
    uint32_t flash_acr, dbg[5], pwr[32], uid[3];
    gpio_state gpio[3];
    timer_state timer[5];
    usart_state usart;
    iwdg_state iwdg;
    adc_state adc;
    host_side host;
    bool system_memory_at_0; /* as the boot loader leaves it; else flash is seen there (SYSCFG_CFGR1.MEM_MODE) */
    uint32_t reset_request; /* a reset_cause, done between two instructions */
} device_state;

#endif
