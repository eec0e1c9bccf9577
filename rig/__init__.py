"""A board behind a serial line: the emulated one and the real one, and the flight with either."""
