"""Many computations that know nothing of one another, on any executor of `concurrent.futures`, each answer kept as soon as it is there."""
