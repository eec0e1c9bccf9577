"""A file of another tool in; its signals by name out: one module for each format, and the table that alone names them all."""
