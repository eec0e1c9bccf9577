"""The serial line to a board: commands in, their typed answers out, over a port that is real, emulated or hostile."""
