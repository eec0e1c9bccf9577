/* Of the Arduino core what the example calls. */
#include <stdint.h>
#include <stdlib.h>
#define OUTPUT 1
static uint32_t micros() { static uint32_t t_us; return t_us += 1000u; }
static void analogWrite(int, int) {}
static void digitalWrite(int, int) {}
static void pinMode(int, int) {}
