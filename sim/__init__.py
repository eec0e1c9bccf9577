"""Equations of each plant, the compiled kernels made from them, and the closed loop."""
