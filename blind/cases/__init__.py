"""The generator: a seed and a kind of rig in, cases with sealed truths out."""
