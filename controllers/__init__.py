"""Controllers: one file and one row each, all behind the same interface, all in the frame that the scheduled law flies in."""
