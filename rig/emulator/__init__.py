"""An STM32G071 in software: core, peripherals, serial line, and the faces under which the rig meets it."""
