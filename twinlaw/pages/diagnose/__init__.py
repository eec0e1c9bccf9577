"""A diagnosis goes in, the report of `twinlaw diagnose` and its few lines for a terminal come out."""
