"""Many computations that know nothing of one another in; their answers out, from any executor, each kept as soon as it is there."""
