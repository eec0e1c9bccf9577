#include "board.h"
#include "stm32g071.h"

/* 32 kHz / 16 / 250 = 8 Hz: a control step that does not finish is over after 125 ms (twelve periods). */
#define RELOAD 249u

void watchdog_start(void)
{
    IWDG->KR = IWDG_KR_START;
    IWDG->KR = IWDG_KR_UNLOCK;
    IWDG->PR = IWDG_PR_DIVIDE_16;
    IWDG->RLR = RELOAD;
    while ((IWDG->SR & (IWDG_SR_PVU | IWDG_SR_RVU)) != 0u) {
    }
    watchdog_feed();
}

void watchdog_feed(void)
{
    IWDG->KR = IWDG_KR_FEED;
}
