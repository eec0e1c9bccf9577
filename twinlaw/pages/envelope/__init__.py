"""Models over the flight envelope go in, the tables and figures of seed 003 in our form come out."""
