"""From a log and a compiled plant to whitened innovations, their likelihood and their slopes by any coefficient."""
