"""A log's columns and their plant in; a column that is in another unit than its name says out, told by what it should equal."""
