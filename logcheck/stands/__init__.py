"""A log's columns in; out where one stands though its axis does not: not read, at the end of a sensor's range, or with the rig off."""
