"""The second rig's effects: those of the contract's table in formulas of its own, and some that the table does not hold."""

from blind.effects.effect import Catalogue
from blind.rigs.second.known import KNOWN, LOOP
from blind.rigs.second.outside import OUTSIDE

CATALOGUE = Catalogue(KNOWN, LOOP, OUTSIDE)
