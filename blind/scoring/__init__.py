"""The scorer: sealed cases and answers in, shares of what was right out."""
