"""Generated C and a board, emulated or real, in; an image on it, the serial line to it and flights with it out."""
