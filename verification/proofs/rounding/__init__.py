"""Rounding: a table and the ranges of motion in, Gappa's bound on each output, held against the ball arithmetic's, out."""
