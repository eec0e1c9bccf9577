/* The control path in a box: bytes and encoder counts in, bytes and duties out, in the order of the board's main loop. */
#include "path.h"

typedef struct {
    uint8_t state;
    uint8_t power;
    int32_t main_ticks;
    int32_t tail_ticks;
    uint32_t steps;
    float psi_start_rad;
    float phi_start_rad;
    float psi_ref_rad;
} box_view;

size_t box_size(void)
{
    return sizeof(path_state);
}

void box_start(path_state *path)
{
    const board_identity identity = {.unique_id = {0xa0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 0xab},
                                     .reset_cause = PROTOCOL_RESET_CAUSE_WATCHDOG,
                                     .resets = 3};
    path_start(path, &identity);
}

void box_fail_self_test(path_state *path)
{
    path->self_test_mismatches = 1;
    path_seal(path);
}

size_t box_feed(path_state *path, const uint8_t *data, size_t count, uint32_t now_us, uint8_t *out)
{
    size_t written = 0;
    for (size_t i = 0; i < count; i++) {
        const path_demand demand = path_receive(path, data[i]);
        if (demand == PATH_NOTHING) {
            continue;
        }
        if (demand == PATH_STEP) {
            path_law(path);
        }
        path_limits(path);
        written += path_reply(path, now_us, out + written);
        path_seal(path);
    }
    return written;
}

size_t box_tick(path_state *path, int32_t psi_counts, int32_t phi_counts, uint32_t passed, uint32_t now_us, uint8_t *out)
{
    const encoder_counts measured = {.psi_counts = psi_counts, .phi_counts = phi_counts};
    if (path_tick(path, &measured, passed) == PATH_STEP) {
        path_law(path);
    }
    path_limits(path);
    const size_t written = path_telemetry(path, now_us, out);
    path_seal(path);
    return written;
}

void box_look(const path_state *path, box_view *view)
{
    view->state = path->supervisor.state;
    view->power = supervisor_power_allowed(&path->supervisor) ? 1 : 0;
    view->main_ticks = path->applied.main_ticks;
    view->tail_ticks = path->applied.tail_ticks;
    view->steps = path->law.steps;
    view->psi_start_rad = path->law.psi_start_rad;
    view->phi_start_rad = path->law.phi_start_rad;
    view->psi_ref_rad = path->input.psi_ref_rad;
}
