"""Recordings of real rigs, imported to run logs: where they come from, and how their files are read."""
