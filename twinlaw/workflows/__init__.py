"""What verbs do across stages: files and options of a command go in, records, written files and progress on the terminal come out."""
