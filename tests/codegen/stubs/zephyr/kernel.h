/* Of the Zephyr kernel what the example calls. */
#include <stdint.h>
#include <stdio.h>
struct k_timer { void (*expired)(struct k_timer *); };
#define K_TIMER_DEFINE(name, expiry, stop) static struct k_timer name = {expiry}
#define K_USEC(us) (us)
#define ARG_UNUSED(x) ((void)(x))
#define printk printf
static void k_timer_start(struct k_timer *timer, int first_us, int period_us)
{
    for (int t_us = first_us; t_us < 10 * period_us; t_us += period_us) timer->expired(timer);
}
