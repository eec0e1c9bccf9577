"""An identification goes in, the report of `twinlaw identify` and the rows that it prints come out."""
