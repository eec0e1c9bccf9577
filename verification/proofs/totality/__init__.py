"""Totality: a table and its C in, questions to an SMT solver on bits, and which claims hold for every input, out."""
