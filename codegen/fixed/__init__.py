"""A controller table in; the words of its law in fixed point, their formats, the exact model and the proof of no overflow out."""
