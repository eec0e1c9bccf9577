"""From a fit and its residuals to how far it may be off: correlation, disagreement of runs, tests of what is left."""
