"""From runs, ranges and what is known before to the parameters that match them best, with the information the data hold."""
