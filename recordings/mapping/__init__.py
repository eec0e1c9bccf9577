"""Signals of a file under foreign names and units in; a plant's columns out: the language that says which is which, and what keeps it."""
