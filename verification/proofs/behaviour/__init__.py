"""Defined behaviour: the generated C in, the alarms of Frama-C EVA under a driver that never ends out."""
