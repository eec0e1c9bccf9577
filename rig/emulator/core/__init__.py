"""The ARMv6-M core in C: halfwords of code and pending exceptions in, the next state of registers and memories out."""
