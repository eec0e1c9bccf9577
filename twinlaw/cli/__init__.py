"""What all verbs share of the command line: words of a person and the shell go in, options, tables and one line for an error come out."""
