"""An image and bytes of a serial line in; what an STM32G071 does with them out: its core and peripherals in software, by the cycle."""
