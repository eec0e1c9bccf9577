"""The emulated chip's whole state in C: addresses and times in, whoever answers or is due there out."""
