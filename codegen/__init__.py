"""Records in, C text out: pure generators."""
