"""A bound plant and wishes for its loops in; the controller table and the report on it out, refused where it would not be stable."""
