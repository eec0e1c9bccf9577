/* In place of a chip's file where the table's loops have no pins: voltages go back over the line, and no power stage is there. */
#include "board.h"

void pwm_start(void)
{
}

void pwm_write(const motor_duties *duty, bool power)
{
    (void)duty;
    (void)power;
}

void pwm_safe(void)
{
}
