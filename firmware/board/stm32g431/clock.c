#include "board.h"
#include "chip.h"

#define STEADY_CLOCKS 128u /* 1 us at 128 MHz */

/* The serial boot loader hands the chip over with the PLL in use; a PLL that runs cannot be set (RM0440 7.4.4). */
static void clock_from_hsi(void)
{
    RCC->CR |= RCC_CR_HSION;
    while ((RCC->CR & RCC_CR_HSIRDY) == 0u) {
    }
    RCC->CFGR = RCC_CFGR_SW_HSI16;
    while ((RCC->CFGR & RCC_CFGR_SWS_MASK) != RCC_CFGR_SWS_HSI16) {
    }
    RCC->CR &= ~RCC_CR_PLLON;
    while ((RCC->CR & RCC_CR_PLLRDY) != 0u) {
    }
}

/* A step beyond 80 MHz goes by half of it for 1 us (RM0440 7.2.7); a turn of the loop takes a clock or more. */
static void clock_from_pll(void)
{
    RCC->CFGR = RCC_CFGR_HPRE_2 | RCC_CFGR_SW_PLLRCLK;
    while ((RCC->CFGR & RCC_CFGR_SWS_MASK) != RCC_CFGR_SWS_PLLRCLK) {
    }
    for (uint32_t i = 0; i < STEADY_CLOCKS; i++) {
        __asm volatile("nop");
    }
    RCC->CFGR = RCC_CFGR_SW_PLLRCLK;
}

/*
 * 16 MHz / 1 * 16 / 2 = 128 MHz, twice the PWM's ticks. Voltage range 1, which holds after a reset, allows 150 MHz without boost,
 * and demands four wait states above 120 MHz (RM0440 3.3.3, 6.1.5).
 */
void clock_start(void)
{
    clock_from_hsi();
    FLASH_ACR = (FLASH_ACR & ~FLASH_ACR_LATENCY_MASK) | FLASH_ACR_LATENCY_4 | FLASH_ACR_PRFTEN | FLASH_ACR_ICEN
        | FLASH_ACR_DCEN;
    while ((FLASH_ACR & FLASH_ACR_LATENCY_MASK) != FLASH_ACR_LATENCY_4) {
    }
    RCC->PLLCFGR = RCC_PLLCFGR_PLLSRC_HSI16 | RCC_PLLCFGR_PLLM_1 | RCC_PLLCFGR_PLLN(16) | RCC_PLLCFGR_PLLR_2;
    RCC->CR |= RCC_CR_PLLON;
    while ((RCC->CR & RCC_CR_PLLRDY) == 0u) {
    }
    RCC->PLLCFGR |= RCC_PLLCFGR_PLLREN;
    clock_from_pll();
}
