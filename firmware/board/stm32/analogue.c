#include "board.h"
#include "chip.h"
#include "wiring.h"

#define REGULATOR_US 20u /* RM0444 15.3.2, RM0440 21.4.6: until the regulator has settled; a turn of the loop takes a clock or more */
#define AFTER_CALIBRATION 32u /* clocks; four of the converter's, RM0444 15.3.3 */

static void wait_turns(uint32_t turns)
{
    for (uint32_t i = 0; i < turns; i++) {
        __asm volatile("nop");
    }
}

/* No digital input on the pin, and no resistor. */
void pin_analogue(uint32_t pin)
{
    GPIOA->PUPDR &= ~(3u << (2u * pin));
    GPIOA->MODER |= GPIO_MODE_ANALOGUE << (2u * pin);
}

/* What never gets ready is ended by the watchdog, as a clock is. */
void analogue_start(void)
{
    clock_to_analogue();
    analogue_set_up();
    ADC->CR = ADC_CR_ADVREGEN;
    wait_turns(REGULATOR_US * (BOARD_CLOCK_HZ / 1000000u));
    ADC->CR = ADC_CR_ADVREGEN | ADC_CR_ADCAL;
    while ((ADC->CR & ADC_CR_ADCAL) != 0u) {
    }
    wait_turns(AFTER_CALIBRATION);
    ADC->ISR = ADC_ISR_ADRDY;
    ADC->CR = ADC_CR_ADVREGEN | ADC_CR_ADEN;
    while ((ADC->ISR & ADC_ISR_ADRDY) == 0u) {
    }
}

/* A turn of the loop takes four clocks or more: it outlasts a conversion twice. */
static bool comes(uint32_t flag)
{
    for (uint32_t turn = 0; turn < ANALOGUE_CONVERSION_CLOCKS / 2u; turn++) {
        if ((ADC->ISR & flag) != 0u) {
            return true;
        }
    }
    return false;
}

uint32_t analogue_read(uint32_t channel)
{
    const uint32_t selected = analogue_select(channel);
    if (selected != 0u && !comes(selected)) {
        return ANALOGUE_SILENT;
    }
    ADC->ISR = ADC_ISR_EOC | ADC_ISR_OVR;
    ADC->CR = ADC_CR_ADVREGEN | ADC_CR_ADSTART; /* a bit that is set stays so */
    return comes(ADC_ISR_EOC) ? ADC->DR & (ANALOGUE_SILENT - 1u) : ANALOGUE_SILENT;
}
