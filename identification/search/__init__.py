"""From the whole range of the parameters to a start for the fit: one file a method, one row of `methods.METHODS`."""
