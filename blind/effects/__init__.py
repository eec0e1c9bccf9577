"""The benchmark's effects: those of the contract's table in other formulations, and some that it does not hold."""

from blind.effects.axis import ONE_AXIS, axis_effects
from blind.effects.driver import LOOP, driver_effects
from blind.effects.effect import Effect, Visited
from blind.effects.outside import OUTSIDE
from blind.effects.rotor import AIR, rotor_effects
from blind.effects.sensor import sensor_effects

PAIRS = tuple(
    effect
    for index in (0, 1)
    for effects in (driver_effects, rotor_effects, axis_effects, sensor_effects)
    for effect in effects(index)
)
KNOWN = (*PAIRS, *AIR, *ONE_AXIS)
TIMING = LOOP

__all__ = ["KNOWN", "OUTSIDE", "TIMING", "Effect", "Visited"]
