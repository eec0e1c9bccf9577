/*
 * The block diagram of the board:
 *
 *     sensors -> commands of the line -> supervisor -> law -> limits -> outputs -> telemetry -> watchdog
 */
#include "board.h"
#include "path.h"

static void run_law(path_state *path)
{
    const uint32_t start = cycle_counter();
    path_law(path);
    path->law_cycles = cycles_between(start, cycle_counter());
}

/* Safety: what the supervisor does not allow does not reach the motors, and the power stage follows its state. */
static void drive_outputs(path_state *path)
{
    const motor_duties *duty = path_limits(path);
    pwm_write(duty, supervisor_power_allowed(&path->supervisor));
}

static void obey(path_state *path, path_demand demand)
{
    if (demand == PATH_BROKEN) {
        board_stop();
    }
    if (demand == PATH_STEP) {
        run_law(path);
    }
}

static void serve_line(path_state *path)
{
    uint8_t byte;
    uint8_t line[PROTOCOL_LINE_MAX];
    while (!tick_waiting() && usart_read(&byte)) {
        const path_demand demand = path_receive(path, byte);
        if (demand == PATH_NOTHING) {
            continue;
        }
        obey(path, demand);
        drive_outputs(path);
        usart_faults(&path->faults);
        usart_write(line, path_reply(path, time_us(), line));
        path_seal(path);
    }
}

static void control_tick(path_state *path, encoder_counts *encoders)
{
    uint8_t line[PROTOCOL_LINE_MAX];
    const uint32_t passed = tick_take();
    const encoder_counts measured = encoders_read(encoders);
    obey(path, path_tick(path, &measured, passed));
    drive_outputs(path);
    usart_write(line, path_telemetry(path, time_us(), line));
    path_seal(path);
    watchdog_feed();
}

int main(void)
{
    static path_state path;
    static encoder_counts encoders;
    watchdog_start();
    clock_start();
    cycle_counter_start();
    pins_start();
    pwm_start();
    encoders_start(&encoders);
    const board_identity identity = board_identify();
    path_start(&path, &identity);
    usart_start();
    tick_start(LAW_SAMPLE_PERIOD_US);
    watchdog_watch_steps();
    for (;;) {
        board_sleep();
        serve_line(&path);
        if (tick_waiting()) {
            control_tick(&path, &encoders);
        }
    }
}
