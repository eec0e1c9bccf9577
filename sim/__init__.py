"""A plant file in; its equations with their effects, bound to numbers, and flights of them, compiled, out."""
