"""The first rig's effects: those of the contract's table in other formulations, and some that it does not hold."""

from blind.rigs.bench import Catalogue
from blind.rigs.first.effects.axis import ONE_AXIS, axis_effects
from blind.rigs.first.effects.driver import LOOP, driver_effects
from blind.rigs.first.effects.outside import OUTSIDE
from blind.rigs.first.effects.rotor import AIR, rotor_effects
from blind.rigs.first.effects.sensor import sensor_effects

PAIRS = tuple(
    effect
    for index in (0, 1)
    for effects in (driver_effects, rotor_effects, axis_effects, sensor_effects)
    for effect in effects(index)
)
CATALOGUE = Catalogue(known=(*PAIRS, *AIR, *ONE_AXIS), timing=LOOP, outside=OUTSIDE)
