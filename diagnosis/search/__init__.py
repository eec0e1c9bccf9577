"""From score tests to fitted hypotheses: singles, pairs and triples, with what must be known of friction, lost frames
and gusts on the way.
"""
