"""From frequency sweeps to the model that matches their conditioned frequency responses (seed 002)."""
