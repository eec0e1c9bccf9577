#include "board.h"
#include "chip.h"

static gpio_registers *registers_of(pin_port port)
{
    return port == PORT_A ? GPIOA : GPIOB;
}

static void set_field(volatile uint32_t *at, uint32_t index, uint32_t width, uint32_t value)
{
    const uint32_t shift = index * width;
    const uint32_t mask = (BIT(width) - 1u) << shift;
    *at = (*at & ~mask) | (value << shift);
}

void pins_start(void)
{
    clock_to_pins();
}

void pin_alternate(pin_port port, uint32_t pin, uint32_t function, bool pull_up)
{
    gpio_registers *gpio = registers_of(port);
    set_field(&gpio->PUPDR, pin, 2, pull_up ? GPIO_PULL_UP : 0u);
    set_field(&gpio->AFR[pin >> 3], pin & 7u, 4, function);
    set_field(&gpio->MODER, pin, 2, GPIO_MODE_ALTERNATE);
}

void pin_output(pin_port port, uint32_t pin)
{
    pin_write(port, pin, false);
    set_field(&registers_of(port)->MODER, pin, 2, GPIO_MODE_OUTPUT);
}

void pin_write(pin_port port, uint32_t pin, bool high)
{
    registers_of(port)->BSRR = high ? BIT(pin) : BIT(pin + 16u);
}
