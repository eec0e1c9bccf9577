"""The chip's peripherals in C, a file each: register accesses and passing time in, pins, bytes and interrupts out."""
