"""From a flight and the law on its board to what firmware or log would have done otherwise: each family of causes in a file."""
