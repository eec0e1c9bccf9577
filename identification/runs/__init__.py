"""From a log to a run: rows cut into windows, a first guess of each window's start, and the readings that parameters predict."""
