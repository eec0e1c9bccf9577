"""The first kind of rig: semi-implicit steps, bristles in the bearings, scheduled pole placement, 10 ms rows, three runs of 60 s."""

from blind.rigs.bench import RigKind
from blind.rigs.first.catalogue import CATALOGUE
from blind.rigs.first.lab import draw_bench

KIND = RigKind(CATALOGUE, draw_bench)
