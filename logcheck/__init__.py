"""From run logs and their plant to findings about the logs themselves: columns, units, stamps, dead readings, seams;
and to the stretches of a long log that are worth a search.
"""
