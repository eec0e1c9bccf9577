"""From flights to linear accelerations as functions of states and controls: classical, linear and fuzzy."""
