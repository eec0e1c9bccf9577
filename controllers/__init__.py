"""A bound plant in; the table of any of several controllers, its law over any arithmetic and its C out, behind one interface."""
