"""From a log to conditioned frequency responses and their coherence."""
