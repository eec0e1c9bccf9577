"""From a plant to its whole library of effects in compiled filters, and from an effect's values to what the filter is
given of them.
"""
