"""Identification in the frequency domain, as in seed 002: sweeps, conditioned frequency responses, a model that matches them."""
