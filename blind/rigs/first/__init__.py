"""A seed in, a rig of the first kind out: semi-implicit steps, bristles in the bearings, scheduled pole placement, rows of 10 ms, three
runs of 60 s."""

from blind.rigs.bench import RigKind
from blind.rigs.first.catalogue import CATALOGUE
from blind.rigs.first.lab import draw_bench

KIND = RigKind(CATALOGUE, draw_bench)
