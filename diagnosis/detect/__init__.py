"""From a fit to the scores of all effects and forms beside it, and to the chance of so large a gap without one."""
