"""A rig's rows of data in (name, place, size, ranges), effects with settings of a simulation and a size in the library's words out."""
