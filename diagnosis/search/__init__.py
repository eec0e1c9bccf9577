"""From score tests to fitted hypotheses: singles, pairs and triples, with what must be known of friction, lost frames
on the way, and whether a gust is the whole gap.
"""
