#include "board.h"
#include "chip.h"

/* 32 kHz / 16 = 2 kHz. */
#define START_RELOAD 4095u /* 2 s: an oscillator that never gets ready, or a self-test without end, starts the board anew */
#define STEP_RELOAD 249u   /* 125 ms (twelve periods): a control step that does not finish is over */

static void set_reload(uint32_t reload)
{
    IWDG->KR = IWDG_KR_UNLOCK;
    IWDG->RLR = reload;
    while ((IWDG->SR & (IWDG_SR_PVU | IWDG_SR_RVU)) != 0u) {
    }
    watchdog_feed();
}

void watchdog_start(void)
{
    IWDG->KR = IWDG_KR_START;
    IWDG->KR = IWDG_KR_UNLOCK;
    IWDG->PR = IWDG_PR_DIVIDE_16;
    set_reload(START_RELOAD);
}

void watchdog_watch_steps(void)
{
    set_reload(STEP_RELOAD);
}

void watchdog_feed(void)
{
    IWDG->KR = IWDG_KR_FEED;
}
