"""From the chosen hypothesis to what a person sees of it: places, times, regions, bands, shapes, sentences, the
improved plant.
"""
