"""The compiled law held against its exact model, and proved bounds on what rounding can do."""
