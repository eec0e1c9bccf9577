"""A constant of the generated C in; what it was made from out, and the description of an image for measurement tools."""
