/*
 * What the STM32G431 (Cortex-M4F) has of its own. Sections are those of the reference manual RM0440, bit names are the manual's.
 * Interrupt numbers are compared with the public device description in the tests.
 */
#ifndef CHIP_H
#define CHIP_H

#include "stm32.h"

/* Interrupt numbers, RM0440 14.3, table of vectors; TIM6 shares its own with the DAC. */
#define IRQ_USART2 38u
#define IRQ_TIM6 54u
#define IRQ_COUNT 102u

/* Reset and clock control, RM0440 7.4. */
typedef struct {
    volatile uint32_t CR;       /* 0x00 */
    volatile uint32_t ICSCR;    /* 0x04 */
    volatile uint32_t CFGR;     /* 0x08 */
    volatile uint32_t PLLCFGR;  /* 0x0c */
    uint32_t unused_10[15];
    volatile uint32_t AHB2ENR;  /* 0x4c */
    uint32_t unused_50[2];
    volatile uint32_t APB1ENR1; /* 0x58 */
    uint32_t unused_5c;
    volatile uint32_t APB2ENR;  /* 0x60 */
    uint32_t unused_64[12];
    volatile uint32_t CSR;      /* 0x94 */
} rcc_registers;
_Static_assert(offsetof(rcc_registers, AHB2ENR) == 0x4c, "RCC layout");
_Static_assert(offsetof(rcc_registers, APB1ENR1) == 0x58, "RCC layout");
_Static_assert(offsetof(rcc_registers, APB2ENR) == 0x60, "RCC layout");
_Static_assert(offsetof(rcc_registers, CSR) == 0x94, "RCC layout");
#define RCC ((rcc_registers *)0x40021000u)

#define RCC_CR_HSION BIT(8)
#define RCC_CR_HSIRDY BIT(10)
#define RCC_CR_PLLON BIT(24)
#define RCC_CR_PLLRDY BIT(25)
#define RCC_CFGR_SW_HSI16 1u
#define RCC_CFGR_SW_PLLRCLK 3u
#define RCC_CFGR_SWS_MASK (3u << 2)
#define RCC_CFGR_SWS_HSI16 (1u << 2)
#define RCC_CFGR_SWS_PLLRCLK (3u << 2)
#define RCC_CFGR_HPRE_2 (8u << 4)
#define RCC_PLLCFGR_PLLSRC_HSI16 2u
#define RCC_PLLCFGR_PLLM_1 (0u << 4)
#define RCC_PLLCFGR_PLLN(n) ((uint32_t)(n) << 8)
#define RCC_PLLCFGR_PLLREN BIT(24)
#define RCC_PLLCFGR_PLLR_2 (0u << 25)
#define RCC_AHB2ENR_GPIOA BIT(0)
#define RCC_AHB2ENR_GPIOB BIT(1)
#define RCC_AHB2ENR_ADC12 BIT(13)
#define RCC_APB1ENR1_TIM2 BIT(0)
#define RCC_APB1ENR1_TIM3 BIT(1)
#define RCC_APB1ENR1_TIM6 BIT(4)
#define RCC_APB1ENR1_USART2 BIT(17)
#define RCC_APB2ENR_TIM1 BIT(11)

/* Flash access control, RM0440 3.7.1. */
#define FLASH_ACR (*(volatile uint32_t *)0x40022000u)
#define FLASH_ACR_LATENCY_MASK 15u
#define FLASH_ACR_LATENCY_4 4u
#define FLASH_ACR_PRFTEN BIT(8)
#define FLASH_ACR_ICEN BIT(9)
#define FLASH_ACR_DCEN BIT(10)

/* Ports, RM0440 2.2. */
#define GPIOA ((gpio_registers *)0x48000000u)
#define GPIOB ((gpio_registers *)0x48000400u)

/* The second converter, RM0440 21.7 and 21.8: at a quarter of the bus' clock, 32 MHz; 92.5 of its clocks to take the voltage, 12.5 to convert it. */
#define ADC ((adc_registers *)0x50000100u)
#define ADC12_CCR (*(volatile uint32_t *)0x50000308u)
#define ADC_CCR_CKMODE_4 (3u << 16)
#define ADC_SMPR_92_CLOCKS 5u
#define ADC_SQR1_FIRST(channel) ((channel) << 6)
#define ANALOGUE_CONVERSION_CLOCKS 420u

#define PRIORITY_BITS 4u /* RM0440 14.1 */

/* Who may use the floating-point unit, PM0214 4.6.1: everybody, CP10 and CP11. */
#define CPACR (*(volatile uint32_t *)0xe000ed88u)
#define CPACR_FPU_FULL (15u << 20)

/* Before the first instruction of the floating-point unit. */
static inline void core_start(void)
{
    CPACR |= CPACR_FPU_FULL;
    __asm volatile("dsb\n\tisb" ::: "memory");
}

static inline void clock_to_pins(void)
{
    RCC->AHB2ENR |= RCC_AHB2ENR_GPIOA | RCC_AHB2ENR_GPIOB;
    (void)RCC->AHB2ENR; /* two clocks until the port answers, RM0440 7.2.17 */
}

static inline void clock_to_encoders(void)
{
    RCC->APB1ENR1 |= RCC_APB1ENR1_TIM2 | RCC_APB1ENR1_TIM3;
}

static inline void clock_to_pwm(void)
{
    RCC->APB2ENR |= RCC_APB2ENR_TIM1;
}

static inline void clock_to_analogue(void)
{
    RCC->AHB2ENR |= RCC_AHB2ENR_ADC12;
    (void)RCC->AHB2ENR;
}

/* Out of deep power-down; the same time for every channel, three bits each. */
static inline void analogue_set_up(void)
{
    ADC->CR = 0;
    ADC12_CCR = ADC_CCR_CKMODE_4;
    ADC->SMPR1 = ADC_SMPR_92_CLOCKS * 01111111111u;
    ADC->SMPR2 = ADC_SMPR_92_CLOCKS * 0111111111u;
}

/* Select the channel, the only one of the sequence, which is so at once: no flag tells. */
static inline uint32_t analogue_select(uint32_t channel)
{
    ADC->SQR1 = ADC_SQR1_FIRST(channel);
    return 0;
}

static inline void clock_to_tick(void)
{
    RCC->APB1ENR1 |= RCC_APB1ENR1_TIM6;
}

static inline void clock_to_line(void)
{
    RCC->APB1ENR1 |= RCC_APB1ENR1_USART2;
}

#endif
