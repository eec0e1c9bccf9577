"""From hypotheses that are still alike to the run that would tell them apart."""
