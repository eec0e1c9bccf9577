"""From the simulated rig of seed 000 to runs of its nine experiments, one file for each way in which the rig stands."""
