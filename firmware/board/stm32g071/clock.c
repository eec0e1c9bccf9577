#include "board.h"
#include "chip.h"

/* The serial boot loader hands the chip over with the PLL in use; a PLL that runs cannot be set (RM0444 5.4.4). */
static void clock_from_hsi(void)
{
    RCC->CR |= RCC_CR_HSION;
    while ((RCC->CR & RCC_CR_HSIRDY) == 0u) {
    }
    RCC->CFGR = RCC_CFGR_SW_HSISYS;
    while ((RCC->CFGR & RCC_CFGR_SWS_MASK) != RCC_CFGR_SWS_HSISYS) {
    }
    RCC->CR &= ~(RCC_CR_PLLON | RCC_CR_HSIDIV_MASK);
    while ((RCC->CR & RCC_CR_PLLRDY) != 0u) {
    }
}

/* 16 MHz / 1 * 8 / 2 = 64 MHz; two wait states are demanded above 48 MHz (RM0444 3.3.4). */
void clock_start(void)
{
    clock_from_hsi();
    FLASH_ACR = (FLASH_ACR & ~FLASH_ACR_LATENCY_MASK) | FLASH_ACR_LATENCY_2 | FLASH_ACR_PRFTEN | FLASH_ACR_ICEN;
    while ((FLASH_ACR & FLASH_ACR_LATENCY_MASK) != FLASH_ACR_LATENCY_2) {
    }
    RCC->PLLCFGR = RCC_PLLCFGR_PLLSRC_HSI16 | RCC_PLLCFGR_PLLM_1 | RCC_PLLCFGR_PLLN(8) | RCC_PLLCFGR_PLLR_2;
    RCC->CR |= RCC_CR_PLLON;
    while ((RCC->CR & RCC_CR_PLLRDY) == 0u) {
    }
    RCC->PLLCFGR |= RCC_PLLCFGR_PLLREN;
    RCC->CFGR = RCC_CFGR_SW_PLLRCLK;
    while ((RCC->CFGR & RCC_CFGR_SWS_MASK) != RCC_CFGR_SWS_PLLRCLK) {
    }
}
