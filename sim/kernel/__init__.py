"""A model in; its equations as functions out: compiled C, and the plain NumPy that it is held against."""
