"""A pilot's inputs in; flights of a simulated helicopter, in place of tests that are not public, their noise unknown to estimators, out."""
