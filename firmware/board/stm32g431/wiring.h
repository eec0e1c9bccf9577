/*
 * What hangs on which pin, and the clock. The numbers are those of records/board.py; the tests compare them.
 *
 *     PA0 PA1   elevation encoder (TIM2)      PA8  PB0   main motor PWM (TIM1 CH1), direction
 *     PA6 PA7   azimuth encoder (TIM3)        PA9  PB1   tail motor PWM (TIM1 CH2), direction
 *     PA2 PA3   serial line (USART2)
 */
#ifndef WIRING_H
#define WIRING_H

#define BOARD_CLOCK_HZ 128000000u

/* On port A, each with the number of its alternate function. */
#define ELEVATION_A_PIN 0u
#define ELEVATION_B_PIN 1u
#define ELEVATION_FUNCTION 1u
#define AZIMUTH_A_PIN 6u
#define AZIMUTH_B_PIN 7u
#define AZIMUTH_FUNCTION 2u
#define MAIN_PWM_PIN 8u
#define TAIL_PWM_PIN 9u
#define PWM_FUNCTION 6u
#define TRANSMIT_PIN 2u
#define RECEIVE_PIN 3u
#define LINE_FUNCTION 7u

/* On port B. */
#define MAIN_DIRECTION_PIN 0u
#define TAIL_DIRECTION_PIN 1u

#endif
