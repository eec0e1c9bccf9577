"""A published recording, by data set and record, in; its run log out: a file for each data set, and the table that names them all."""
