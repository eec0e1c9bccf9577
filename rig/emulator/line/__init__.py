"""The serial line in C: bytes with the time at which they start in, levels as a receiver with a clock of its own samples them out."""
