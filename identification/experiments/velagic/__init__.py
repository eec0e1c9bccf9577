"""From the simulated rig of seed 001 to runs of its four experiments, and to the step responses of its figures."""
