"""The file of a recording, a data set or another tool in; a run log with notes on what it lacks out."""
