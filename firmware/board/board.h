/*
 * What a chip gives to the main loop: two quadrature encoders, analogue inputs, two PWM outputs with direction, one serial line.
 * A file for each part below is in the family's folder, or in the chip's where chips differ: its clock, its registers in chip.h,
 * its wiring in wiring.h, its memories in records/board.py.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "exchange.h"

/* clock.c */
void clock_start(void); /* to BOARD_CLOCK_HZ */

/* cycles.c */
void cycle_counter_start(void);
uint32_t cycle_counter(void); /* core cycles, modulo 2^24, counting up */
uint32_t cycles_between(uint32_t start, uint32_t end);

/* pins.c */
typedef enum { PORT_A, PORT_B } pin_port;
void pins_start(void);
void pin_alternate(pin_port port, uint32_t pin, uint32_t function, bool pull_up);
void pin_output(pin_port port, uint32_t pin);
void pin_write(pin_port port, uint32_t pin, bool high);

/* analogue.c, where a loop has an analogue sensor */
#define ANALOGUE_SILENT 4096u /* beyond the 12 bits of a code */
void pin_analogue(uint32_t pin); /* on port A */
void analogue_start(void);
uint32_t analogue_read(uint32_t channel); /* the code now, 0 to 4095; ANALOGUE_SILENT where the converter does not end in time */

/* encoders.c: encoders, and what else measures an angle */
void encoders_start(encoder_counts *self);
encoder_counts encoders_read(encoder_counts *self); /* within every 32 767 counts of azimuth */

/* pwm.c */
void pwm_start(void);                              /* power stage off */
void pwm_write(const motor_duties *duty, bool power); /* signed ticks; power = false opens the power stage at once */
void pwm_safe(void);                               /* power stage off, whatever has happened */

/* tick.c */
void tick_start(uint32_t period_us); /* up to 65536 */
uint32_t tick_take(void); /* control ticks since the last call */
bool tick_waiting(void);
uint32_t time_us(void);   /* modulo 2^32 */

/* usart.c */
void usart_start(void);
bool usart_read(uint8_t *byte);
bool usart_waiting(void);
void usart_write(const uint8_t *line, size_t length); /* all of it or, counted, nothing */
void usart_faults(board_faults *faults);

/* watchdog.c */
void watchdog_start(void);       /* before all else: two seconds for the start */
void watchdog_watch_steps(void); /* from here on a control step must finish within 125 ms */
void watchdog_feed(void);

/* identity.c */
board_identity board_identify(void); /* reads and clears the reset cause */

/* sleep.c */
void board_sleep(void); /* until an interrupt has left work */

/* startup.c */
_Noreturn void board_stop(void); /* rotors off, then wait for the watchdog to start the board anew */
void stack_check(void);          /* stops the board when the stack has left its reserve */

#endif
