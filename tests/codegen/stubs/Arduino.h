/* Of the Arduino core what the example calls. */
#include <stdint.h>
#include <stdlib.h>
struct Port { void begin(long) {} void println(const char *) {} };
static Port Serial;
static uint32_t micros() { static uint32_t t_us; return t_us += 1000u; }
static void analogWrite(int, int) {}
