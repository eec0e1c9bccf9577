/* Analogue-digital converter (RM0444 15): one conversion of one channel at a time, started by software, 12 bits to the right.
 *
 * The host sets the code of each channel; it is taken as the conversion starts, and there when that has ended. */
#include "peripherals.h"

enum { ISR = 0, CR = 2, CFGR2 = 4, SMPR = 5, CHSELR = 10, DR = 16 }; /* word offsets */
enum { ADRDY = 1, EOC = 1 << 2, OVR = 1 << 4, EOCAL = 1 << 11, CCRDY = 1 << 13 };
enum { ADEN = 1, ADSTART = 1 << 2 };
#define ADVREGEN (1u << 28)
#define ADCAL (1u << 31)

#define FASTEST_HZ 35000000ull          /* STM32G071 data sheet, fADC in range 1 */
#define REGULATOR_US 20u                /* data sheet, tADCVREG_SETUP */
#define CALIBRATION_CLOCKS 82u          /* RM0444 15.3.3 */
#define AFTER_CALIBRATION_CLOCKS 4u
#define CHANNELS_ON_PORT_A 8u           /* channel n is on pin PAn; the others are not modelled */

static const uint32_t SAMPLING_HALF_CLOCKS[] = {3, 7, 15, 25, 39, 79, 159, 321}; /* RM0444 15.12.6 */
enum { CONVERTING_HALF_CLOCKS = 25 };

void adc_reset(machine *m) {
    adc_state before = m->device.adc;
    m->device.adc = (adc_state){0};
    for (uint32_t channel = 0; channel < ADC_CHANNELS; channel++) m->device.adc.code[channel] = before.code[channel];
    m->device.adc.silent = before.silent;
}

/* Core cycles of one clock of the converter; 0 for a clock that is not modelled, or too fast. */
static uint64_t clock_cycles(const machine *m) {
    static const uint32_t DIVIDERS[] = {0, 2, 4, 1}; /* CKMODE, RM0444 15.12.5 */
    uint64_t cycles = (uint64_t)DIVIDERS[m->device.adc.reg[CFGR2] >> 30] * m->device.clock.apb_divider;
    return cycles && m->device.clock.hz <= FASTEST_HZ * cycles ? cycles : 0;
}

static void settle(machine *m) {
    adc_state *a = &m->device.adc;
    if (m->core.now < a->due || a->silent) return;
    if (a->reg[CR] & ADCAL) a->reg[CR] &= ~ADCAL, a->reg[ISR] |= EOCAL;
    if (a->reg[CR] & ADSTART) {
        a->reg[CR] &= ~(uint32_t)ADSTART;
        a->reg[ISR] |= a->reg[ISR] & EOC ? OVR : EOC;
        a->reg[DR] = a->taken;
    }
}

bool adc_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    adc_state *a = &m->device.adc;
    uint32_t word = offset / 4;
    settle(m);
    if (word > DR) return false;
    *value = a->reg[word];
    if (word == DR) a->reg[ISR] &= ~(uint32_t)EOC;
    return true;
}

static bool start_calibration(machine *m) {
    adc_state *a = &m->device.adc;
    uint64_t settled = a->powered + REGULATOR_US * m->device.clock.hz / 1000000u;
    if (a->reg[CR] != ADVREGEN || m->core.now < settled || !clock_cycles(m)) return false;
    a->reg[CR] |= ADCAL;
    a->due = m->core.now + CALIBRATION_CLOCKS * clock_cycles(m);
    a->calibrated = a->due + AFTER_CALIBRATION_CLOCKS * clock_cycles(m);
    return true;
}

static bool enable(machine *m) {
    adc_state *a = &m->device.adc;
    if (a->reg[CR] != ADVREGEN || !a->calibrated || m->core.now < a->calibrated || !clock_cycles(m)) return false;
    a->reg[CR] |= ADEN;
    a->reg[ISR] |= ADRDY;
    return true;
}

/* The channel that is selected, where it is one alone and its pin is set for it; none of them else. */
static uint32_t selected(const machine *m) {
    for (uint32_t channel = 0; channel < CHANNELS_ON_PORT_A; channel++)
        if (m->device.adc.reg[CHSELR] == 1u << channel && (m->device.gpio[0].reg[0] >> 2 * channel & 3u) == 3u) return channel;
    return CHANNELS_ON_PORT_A;
}

static bool start_conversion(machine *m) {
    adc_state *a = &m->device.adc;
    uint32_t channel = selected(m), half_clocks = SAMPLING_HALF_CLOCKS[a->reg[SMPR] & 7u] + CONVERTING_HALF_CLOCKS;
    if (a->reg[CR] != (ADVREGEN | ADEN) || channel == CHANNELS_ON_PORT_A) return false;
    a->reg[CR] |= ADSTART;
    a->taken = a->code[channel];
    a->due = m->core.now + half_clocks * clock_cycles(m) / 2u;
    return true;
}

/* Bits of CR are set by writing 1 and fall by themselves; switching off is not modelled. */
static bool control(machine *m, uint32_t value) {
    adc_state *a = &m->device.adc;
    uint32_t news = value & ~a->reg[CR];
    if (news & ADVREGEN) a->powered = m->core.now, a->reg[CR] |= ADVREGEN, news &= ~ADVREGEN;
    switch (news) {
    case 0: return value & ADVREGEN;
    case ADCAL: return start_calibration(m);
    case ADEN: return enable(m);
    case ADSTART: return start_conversion(m);
    default: return false;
    }
}

/* Interrupts, DMA, triggers, other resolutions, sequences, oversampling, watchdogs and the channels inside are not modelled. */
bool adc_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)index;
    adc_state *a = &m->device.adc;
    uint32_t word = offset / 4;
    settle(m);
    switch (word) {
    case ISR: a->reg[ISR] &= ~value; return true;
    case CR: return control(m, value);
    case CFGR2: a->reg[CFGR2] = value; return !(a->reg[CR] & (ADEN | ADCAL)) && !(value & 0x3FFFFFFFu);
    case SMPR: a->reg[SMPR] = value; return !(a->reg[CR] & ADSTART) && value <= 7u;
    case CHSELR: a->reg[CHSELR] = value, a->reg[ISR] |= CCRDY; return !(a->reg[CR] & ADSTART);
    default: return value == 0;
    }
}

void adc_set_code(machine *m, uint32_t channel, uint32_t code) { m->device.adc.code[channel] = code; }

/* From now on no conversion ends. */
void adc_silence(machine *m) { m->device.adc.silent = true; }
