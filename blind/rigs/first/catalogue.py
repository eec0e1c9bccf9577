"""The first rig's effects: those of the contract's table, and some that it does not hold."""

from blind.effects.effect import Catalogue
from blind.rigs.first.known import KNOWN, LOOP
from blind.rigs.first.outside import OUTSIDE

CATALOGUE = Catalogue(KNOWN, LOOP, OUTSIDE)
