"""Symbolic expressions in; their derivatives and short lists of C assignments out."""
