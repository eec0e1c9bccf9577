"""Reports: records go in, a self-contained HTML page and rows for the terminal come out; a folder a verb, and here what all share."""
