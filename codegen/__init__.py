"""Records in; C text out, purely: the same record gives the same bytes."""
