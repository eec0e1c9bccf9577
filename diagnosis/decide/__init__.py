"""From fitted hypotheses and their hold-out errors to probabilities, reasons to doubt, and what is named."""
