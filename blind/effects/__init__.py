"""What an effect is: a size and a shape in, settings of a simulation and the size in the library's words out."""
