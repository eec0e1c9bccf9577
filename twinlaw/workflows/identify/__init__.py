"""Experiments and logs of a rig go in, an identified plant with its files comes out, of an interrupted run what was found so far."""
