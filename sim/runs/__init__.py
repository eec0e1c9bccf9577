"""A bound plant with inputs or a controller in; its states, outputs and their derivatives over time out."""
