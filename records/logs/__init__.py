"""What is told of run logs beside their rows: where each comes from, where a clock begins again; and a row as it comes, in; records out."""
