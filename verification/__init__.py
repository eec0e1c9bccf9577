"""A controller table and its compiled law in; equality with the exact model, bounds on rounding, cycles and stack, and proofs out."""
