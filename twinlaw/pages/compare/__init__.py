"""A comparison of controllers goes in, docs/controllers.md, its tables and its plots come out."""
