"""From logs and an effect library to a case, and from what one supposes of the plant to its innovations over all
logs.
"""
