/*
 * The registers that the chips of this family have at the same place, and that this firmware uses; what differs is in chip.h.
 *
 * Sections are those of the reference manual RM0444 (STM32G0x1), of PM0223 for the core; RM0440 (STM32G4) and PM0214 describe the
 * same registers. Bit names are RM0444's.
 */
#ifndef STM32_H
#define STM32_H

#include <stddef.h>
#include <stdint.h>

#define BIT(n) (1u << (n))

/* Causes of a reset, RM0444 5.4.24; bit 27 is BORRSTF in RM0440. */
#define RCC_CSR_RMVF BIT(23)
#define RCC_CSR_PINRSTF BIT(26)
#define RCC_CSR_PWRRSTF BIT(27)
#define RCC_CSR_SFTRSTF BIT(28)
#define RCC_CSR_IWDGRSTF BIT(29)

/* General purpose pins, RM0444 7.4. */
typedef struct {
    volatile uint32_t MODER;   /* 0x00, 7.4.1 */
    volatile uint32_t OTYPER;  /* 0x04 */
    volatile uint32_t OSPEEDR; /* 0x08 */
    volatile uint32_t PUPDR;   /* 0x0c, 7.4.4 */
    volatile uint32_t IDR;     /* 0x10 */
    volatile uint32_t ODR;     /* 0x14 */
    volatile uint32_t BSRR;    /* 0x18, 7.4.7 */
    uint32_t unused_1c;
    volatile uint32_t AFR[2];  /* 0x20, 7.4.9 */
} gpio_registers;
_Static_assert(offsetof(gpio_registers, AFR) == 0x20, "GPIO layout");

#define GPIO_MODE_OUTPUT 1u
#define GPIO_MODE_ALTERNATE 2u
#define GPIO_MODE_ANALOGUE 3u
#define GPIO_PULL_UP 1u

/* Timers: TIM1 RM0444 21.4, TIM2/TIM3 22.4, TIM6 23.4; one layout, of which a basic timer has a part. */
typedef struct {
    volatile uint32_t CR1;   /* 0x00, 21.4.1 */
    volatile uint32_t CR2;   /* 0x04 */
    volatile uint32_t SMCR;  /* 0x08, 22.4.3 */
    volatile uint32_t DIER;  /* 0x0c, 23.4.3 */
    volatile uint32_t SR;    /* 0x10, 23.4.4 */
    volatile uint32_t EGR;   /* 0x14 */
    volatile uint32_t CCMR1; /* 0x18, 21.4.7 */
    volatile uint32_t CCMR2; /* 0x1c */
    volatile uint32_t CCER;  /* 0x20, 21.4.11 */
    volatile uint32_t CNT;   /* 0x24 */
    volatile uint32_t PSC;   /* 0x28 */
    volatile uint32_t ARR;   /* 0x2c */
    volatile uint32_t RCR;   /* 0x30 */
    volatile uint32_t CCR1;  /* 0x34, 21.4.16 */
    volatile uint32_t CCR2;  /* 0x38 */
    volatile uint32_t CCR3;  /* 0x3c */
    volatile uint32_t CCR4;  /* 0x40 */
    volatile uint32_t BDTR;  /* 0x44, 21.4.20 */
} timer_registers;
_Static_assert(offsetof(timer_registers, CNT) == 0x24, "timer layout");
_Static_assert(offsetof(timer_registers, BDTR) == 0x44, "timer layout");
#define TIM1 ((timer_registers *)0x40012c00u)
#define TIM2 ((timer_registers *)0x40000000u)
#define TIM3 ((timer_registers *)0x40000400u)
#define TIM6 ((timer_registers *)0x40001000u)

#define TIM_CR1_CEN BIT(0)
#define TIM_CR1_ARPE BIT(7)
#define TIM_DIER_UIE BIT(0)
#define TIM_SR_UIF BIT(0)
#define TIM_EGR_UG BIT(0)
#define TIM_SMCR_SMS_BOTH_EDGES 3u
#define TIM_CCMR1_CC1S_TI1 1u
#define TIM_CCMR1_CC2S_TI2 (1u << 8)
#define TIM_CCMR1_IC1F_8_SAMPLES (3u << 4)
#define TIM_CCMR1_IC2F_8_SAMPLES (3u << 12)
#define TIM_CCMR1_OC1M_PWM1 (6u << 4)
#define TIM_CCMR1_OC1PE BIT(3)
#define TIM_CCMR1_OC2M_PWM1 (6u << 12)
#define TIM_CCMR1_OC2PE BIT(11)
#define TIM_CCER_CC1E BIT(0)
#define TIM_CCER_CC2E BIT(4)
#define TIM_BDTR_OSSI BIT(10)
#define TIM_BDTR_MOE BIT(15)

/* Serial port, RM0444 33.8. */
typedef struct {
    volatile uint32_t CR1;  /* 0x00, 33.8.1 */
    volatile uint32_t CR2;  /* 0x04 */
    volatile uint32_t CR3;  /* 0x08, 33.8.4 */
    volatile uint32_t BRR;  /* 0x0c, 33.8.5 */
    uint32_t unused_10[3];
    volatile uint32_t ISR;  /* 0x1c, 33.8.9 */
    volatile uint32_t ICR;  /* 0x20, 33.8.11 */
    volatile uint32_t RDR;  /* 0x24 */
    volatile uint32_t TDR;  /* 0x28 */
} usart_registers;
_Static_assert(offsetof(usart_registers, ISR) == 0x1c, "USART layout");
_Static_assert(offsetof(usart_registers, TDR) == 0x28, "USART layout");
#define USART2 ((usart_registers *)0x40004400u)

#define USART_CR1_UE BIT(0)
#define USART_CR1_RE BIT(2)
#define USART_CR1_TE BIT(3)
#define USART_CR1_RXNEIE BIT(5)
#define USART_CR1_TXEIE BIT(7)
#define USART_ISR_FE BIT(1)
#define USART_ISR_NE BIT(2)
#define USART_ISR_ORE BIT(3)
#define USART_ISR_RXNE BIT(5)
#define USART_ISR_TXE BIT(7)
#define USART_ICR_FECF BIT(1)
#define USART_ICR_NECF BIT(2)
#define USART_ICR_ORECF BIT(3)

/* Analogue-digital converter, RM0444 15.12; RM0440 21.7 has registers for channels of its own. */
typedef struct {
    volatile uint32_t ISR;    /* 0x00, 15.12.1 */
    volatile uint32_t IER;    /* 0x04 */
    volatile uint32_t CR;     /* 0x08, 15.12.3 */
    volatile uint32_t CFGR;   /* 0x0c, CFGR1 in RM0444 */
    volatile uint32_t CFGR2;  /* 0x10, 15.12.5 */
    volatile uint32_t SMPR1;  /* 0x14, 15.12.6, SMPR in RM0444 */
    volatile uint32_t SMPR2;  /* 0x18, RM0440 alone */
    uint32_t unused_1c[3];
    volatile uint32_t CHSELR; /* 0x28, 15.12.9, RM0444 alone */
    uint32_t unused_2c;
    volatile uint32_t SQR1;   /* 0x30, RM0440 alone */
    uint32_t unused_34[3];
    volatile uint32_t DR;     /* 0x40, 15.12.13 */
} adc_registers;
_Static_assert(offsetof(adc_registers, CHSELR) == 0x28, "ADC layout");
_Static_assert(offsetof(adc_registers, SQR1) == 0x30, "ADC layout");
_Static_assert(offsetof(adc_registers, DR) == 0x40, "ADC layout");

#define ADC_ISR_ADRDY BIT(0)
#define ADC_ISR_EOC BIT(2)
#define ADC_ISR_OVR BIT(4)
#define ADC_CR_ADEN BIT(0)
#define ADC_CR_ADSTART BIT(2)
#define ADC_CR_ADVREGEN BIT(28)
#define ADC_CR_ADCAL BIT(31)

/* Independent watchdog, RM0444 28.4. */
typedef struct {
    volatile uint32_t KR;  /* 0x00, 28.4.1 */
    volatile uint32_t PR;  /* 0x04, 28.4.2 */
    volatile uint32_t RLR; /* 0x08, 28.4.3 */
    volatile uint32_t SR;  /* 0x0c, 28.4.4 */
} iwdg_registers;
#define IWDG ((iwdg_registers *)0x40003000u)

#define IWDG_KR_START 0xccccu
#define IWDG_KR_UNLOCK 0x5555u
#define IWDG_KR_FEED 0xaaaau
#define IWDG_PR_DIVIDE_16 2u
#define IWDG_SR_PVU BIT(0)
#define IWDG_SR_RVU BIT(1)

/* Unique device number, RM0444 38.1. */
#define UNIQUE_ID ((const volatile uint32_t *)0x1fff7590u)

/* Where the vectors stand, PM0223 4.3.4. */
#define SCB_VTOR (*(volatile uint32_t *)0xe000ed08u)

/* System timer, PM0223 4.4; interrupt controller, PM0223 4.2. */
typedef struct {
    volatile uint32_t CSR;
    volatile uint32_t RVR;
    volatile uint32_t CVR;
} systick_registers;
#define SYSTICK ((systick_registers *)0xe000e010u)
#define SYSTICK_CSR_ENABLE BIT(0)
#define SYSTICK_CSR_CORE_CLOCK BIT(2)
#define SYSTICK_MASK 0x00ffffffu

#define NVIC_ISER ((volatile uint32_t *)0xe000e100u) /* 32 interrupts a word */
#define NVIC_IPR ((volatile uint32_t *)0xe000e400u)  /* four interrupts a word, PRIORITY_BITS each, at the top of their byte */

#endif
