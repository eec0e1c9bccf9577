"""The bytes of a text file in; its columns by heading out: letters, cells, how the table is laid out."""
