"""The image and its way into a chip: generated C in, a programmed board out."""
