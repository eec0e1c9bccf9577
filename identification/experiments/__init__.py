"""From a simulated rig, or a record of a real one, to runs for the estimator; each experiment is one entry of `table.BY_PLANT`."""
