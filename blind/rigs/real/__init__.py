"""A seed in, a rig of the third kind out: several plants, errors of the colour that real recordings have, logs as people make them.

It shares with the others only what a case is and how it is sized and sealed, and of a CE150 what the library's formulas are.
"""

from functools import partial

from blind.rigs.bench import RigKind
from blind.rigs.real.catalogue import CATALOGUES
from blind.rigs.real.lab import draw_bench
from blind.rigs.real.plants import PLANTS

KINDS = tuple(
    RigKind(CATALOGUES[plant.name], partial(draw_bench, plant), plant.path, plant.read, plant.beside)
    for plant in PLANTS
)
