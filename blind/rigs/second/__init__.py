"""A seed in, a rig of the second kind out: Runge-Kutta steps of 125 us, three laws of friction, three kinds of controller, rows of 5
to 20 ms.

It shares with the first only what a case is and how it is sized and sealed: motion, friction, controllers, manoeuvres,
sensors and the formulas of its effects are its own.
"""

from blind.rigs.bench import RigKind
from blind.rigs.second.catalogue import CATALOGUE
from blind.rigs.second.lab import draw_bench

KIND = RigKind(CATALOGUE, draw_bench)
