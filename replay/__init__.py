"""From a run log and its controller table to what the firmware did: bit-exact, or the first difference and its
cause.
"""
