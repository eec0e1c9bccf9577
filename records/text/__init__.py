"""The text of a file that a user hands over in; its kinds, numbers, rows and units, checked, or one BadInput out."""
