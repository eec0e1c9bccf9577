"""The emulated chip as a serial port: an image and the bytes of a host in, the bytes of the board or of its boot loader out."""
