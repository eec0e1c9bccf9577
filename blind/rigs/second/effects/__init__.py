"""The second rig's effects: those of the contract's table in formulas of its own, and some that the table does not
hold."""

from blind.rigs.bench import Catalogue
from blind.rigs.second.effects.axis import ONE_AXIS, axis_effects
from blind.rigs.second.effects.bearing import ASYMMETRY, bearing_effects
from blind.rigs.second.effects.driver import LOOP, driver_effects
from blind.rigs.second.effects.outside_axis import AXES
from blind.rigs.second.effects.outside_drive import DRIVES, ENCODERS, ROTORS
from blind.rigs.second.effects.rotor import AIR, rotor_effects
from blind.rigs.second.effects.sensor import sensor_effects

PAIRS = tuple(
    effect
    for index in (0, 1)
    for effects in (driver_effects, rotor_effects, bearing_effects, axis_effects, sensor_effects)
    for effect in effects(index)
)
CATALOGUE = Catalogue(
    known=(*PAIRS, *AIR, *ONE_AXIS, ASYMMETRY), timing=LOOP, outside=(*AXES, *ROTORS, *DRIVES, *ENCODERS)
)
