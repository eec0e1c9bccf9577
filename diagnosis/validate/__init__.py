"""From a hypothesis to its predictions of logs that were not fitted, and how far they are off."""
