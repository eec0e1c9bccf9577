"""A design rule, equations over any arithmetic and a template of C in; table, float law, exact twin and C of the controller out."""
