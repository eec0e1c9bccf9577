"""From a hypothesis to the values that fit best, with evidence, process noise and jitter."""
