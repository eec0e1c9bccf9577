/*
 * What the STM32G071 (Cortex-M0+) has of its own. Sections are those of the reference manual RM0444, bit names are the manual's.
 * Interrupt numbers are compared with the public device description in the tests.
 */
#ifndef CHIP_H
#define CHIP_H

#include "stm32.h"

/* Interrupt numbers, RM0444 12.3, table of vectors. */
#define IRQ_TIM6 17u
#define IRQ_USART2 28u
#define IRQ_COUNT 32u

/* Reset and clock control, RM0444 5.4. */
typedef struct {
    volatile uint32_t CR;             /* 0x00, 5.4.1 */
    volatile uint32_t ICSCR;          /* 0x04 */
    volatile uint32_t CFGR;           /* 0x08, 5.4.3 */
    volatile uint32_t PLLCFGR;        /* 0x0c, 5.4.4 */
    uint32_t unused_10[9];
    volatile uint32_t IOPENR;         /* 0x34, 5.4.13 */
    volatile uint32_t AHBENR;         /* 0x38 */
    volatile uint32_t APBENR1;        /* 0x3c, 5.4.15 */
    volatile uint32_t APBENR2;        /* 0x40, 5.4.16 */
    uint32_t unused_44[7];
    volatile uint32_t CSR;            /* 0x60, 5.4.24 */
} rcc_registers;
_Static_assert(offsetof(rcc_registers, IOPENR) == 0x34, "RCC layout");
_Static_assert(offsetof(rcc_registers, CSR) == 0x60, "RCC layout");
#define RCC ((rcc_registers *)0x40021000u)

#define RCC_CR_HSION BIT(8)
#define RCC_CR_HSIRDY BIT(10)
#define RCC_CR_HSIDIV_MASK (7u << 11)
#define RCC_CR_PLLON BIT(24)
#define RCC_CR_PLLRDY BIT(25)
#define RCC_CFGR_SW_HSISYS 0u
#define RCC_CFGR_SW_PLLRCLK 2u
#define RCC_CFGR_SWS_MASK (7u << 3)
#define RCC_CFGR_SWS_HSISYS (0u << 3)
#define RCC_CFGR_SWS_PLLRCLK (2u << 3)
#define RCC_PLLCFGR_PLLSRC_HSI16 2u
#define RCC_PLLCFGR_PLLM_1 (0u << 4)
#define RCC_PLLCFGR_PLLN(n) ((uint32_t)(n) << 8)
#define RCC_PLLCFGR_PLLREN BIT(28)
#define RCC_PLLCFGR_PLLR_2 (1u << 29)
#define RCC_IOPENR_GPIOA BIT(0)
#define RCC_IOPENR_GPIOB BIT(1)
#define RCC_APBENR1_TIM2 BIT(0)
#define RCC_APBENR1_TIM3 BIT(1)
#define RCC_APBENR1_TIM6 BIT(4)
#define RCC_APBENR1_USART2 BIT(17)
#define RCC_APBENR2_TIM1 BIT(11)
#define RCC_APBENR2_ADC BIT(20)

/* Flash access control, RM0444 3.7.1. */
#define FLASH_ACR (*(volatile uint32_t *)0x40022000u)
#define FLASH_ACR_LATENCY_MASK 7u
#define FLASH_ACR_LATENCY_2 2u
#define FLASH_ACR_PRFTEN BIT(8)
#define FLASH_ACR_ICEN BIT(9)

/* Ports, RM0444 2.2. */
#define GPIOA ((gpio_registers *)0x50000000u)
#define GPIOB ((gpio_registers *)0x50000400u)

/* The converter, RM0444 15.12: at a quarter of the bus' clock, 16 MHz; 39.5 of its clocks to take the voltage, 12.5 to convert it. */
#define ADC ((adc_registers *)0x40012400u)
#define ADC_ISR_CCRDY BIT(13)
#define ADC_CFGR2_CKMODE_4 (2u << 30)
#define ADC_SMPR_39_CLOCKS 5u
#define ANALOGUE_CONVERSION_CLOCKS 208u

#define PRIORITY_BITS 2u /* PM0223 4.2.7 */

/* The core has nothing to be switched on. */
static inline void core_start(void)
{
}

static inline void clock_to_pins(void)
{
    RCC->IOPENR |= RCC_IOPENR_GPIOA | RCC_IOPENR_GPIOB;
    (void)RCC->IOPENR; /* two clocks until the port answers, RM0444 5.2.16 */
}

static inline void clock_to_encoders(void)
{
    RCC->APBENR1 |= RCC_APBENR1_TIM2 | RCC_APBENR1_TIM3;
}

static inline void clock_to_pwm(void)
{
    RCC->APBENR2 |= RCC_APBENR2_TIM1;
}

static inline void clock_to_analogue(void)
{
    RCC->APBENR2 |= RCC_APBENR2_ADC;
}

static inline void analogue_set_up(void)
{
    ADC->CFGR2 = ADC_CFGR2_CKMODE_4;
    ADC->SMPR1 = ADC_SMPR_39_CLOCKS;
}

/* Select the channel; the flag that tells when it is, 0 where it was before. */
static inline uint32_t analogue_select(uint32_t channel)
{
    if (ADC->CHSELR == BIT(channel)) {
        return 0;
    }
    ADC->ISR = ADC_ISR_CCRDY;
    ADC->CHSELR = BIT(channel);
    return ADC_ISR_CCRDY;
}

static inline void clock_to_tick(void)
{
    RCC->APBENR1 |= RCC_APBENR1_TIM6;
}

static inline void clock_to_line(void)
{
    RCC->APBENR1 |= RCC_APBENR1_USART2;
}

#endif
