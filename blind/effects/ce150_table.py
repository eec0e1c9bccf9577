"""The contract's table of effects on a CE150: what each is called, where it sits, on what it depends, the library's formula."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Unpack

from blind.effects import ce150_formulas as formulas
from blind.effects.ce150_formulas import Formula, OwnLaw
from blind.effects.effect import Effect, Size
from blind.effects.row import Traits, known, outside

# What the words in braces are for index 0 and 1.
WORDS: tuple[Mapping[str, str], ...] = (
    {"rotor": "main", "axis": "elevation", "angle": "psi", "letter": "M", "other": "T"},
    {"rotor": "tail", "axis": "azimuth", "angle": "phi", "letter": "T", "other": "M"},
)


@dataclass(frozen=True)
class Entry:
    """What the table says of an effect, whichever rig has it; no formula where each rig says itself what its number is there."""

    depends: str
    formula: Formula | None
    sensor: bool = False
    needs: str = ""


TABLE: Mapping[str, Entry] = {
    "{rotor}_input.deadzone": Entry("dead band of u_{letter}", formulas.dead_zone),
    "{rotor}_input.saturation": Entry("limit of u_{letter}", formulas.saturation),
    "{rotor}_input.supply_sag": Entry("gain(u_M, u_T) of u_{letter}", formulas.supply_sag),
    "{rotor}_input.delay": Entry("delay of u_{letter}", formulas.same("tau")),
    "{rotor}_input.slew_limit": Entry("rate limit of u_{letter}", formulas.same("r")),
    "{rotor}_input.quantization": Entry("steps of u_{letter}", formulas.same("q")),
    "{rotor}_input.lag": Entry("lag of u_{letter}", formulas.same("tau")),
    "{rotor}_rotor.warmup": Entry("gain(t) of omega_{letter}", formulas.warm_up),
    "{rotor}_rotor.dry_friction": Entry("torque(sgn omega_{letter}) on rotor", formulas.dry_rotor),
    "main_rotor.ground_effect": Entry("thrust(psi)", formulas.ground_effect),
    "tail_rotor.reverse_asymmetry": Entry("thrust(sgn omega_T)", formulas.reversed_thrust, needs="reversal"),
    "tail_rotor.downwash": Entry("thrust(omega_M)", formulas.downwash),
    "{axis}.coulomb": Entry("torque(sgn {angle}_dot) on {axis}", formulas.same("b")),
    "{axis}.stribeck": Entry("torque({angle}_dot) on {axis}", formulas.stribeck),
    "{axis}.quadratic_drag": Entry("torque({angle}_dot) on {axis}", formulas.quadratic_drag),
    "{axis}.cable_spring": Entry("torque({angle}) on {axis}", formulas.cable_spring),
    "{axis}.rotor_acceleration": Entry("torque(domega_{other}/dt) on {axis}", formulas.same("J", either_sign=True)),
    "{axis}.disturbance": Entry("torque(t) on {axis}", formulas.disturbance),
    "{axis}.flexible_mode": Entry("mode(torque) of {axis}", None, sensor=True),
    "elevation.centre_of_gravity": Entry("torque(psi) on elevation", formulas.centre_of_gravity),
    "elevation.weight_shift": Entry("torque(t) on elevation", formulas.weight_shift),
    "elevation.tail_coupling": Entry("torque(omega_T) on elevation", formulas.tail_coupling),
    "azimuth.tilt": Entry("torque(phi) on azimuth", formulas.tilt),
    "azimuth.gyroscopic": Entry("torque(psi_dot, omega_M, psi) on azimuth", formulas.gyroscopic),
    "azimuth.friction_asymmetry": Entry(
        "torque(sgn phi_dot) on azimuth", formulas.same("difference", either_sign=True)
    ),
    "{angle}_sensor.offset": Entry("offset of {angle}", formulas.sensor_offset, sensor=True),
    "{angle}_sensor.scale": Entry("scale of {angle}", formulas.sensor_scale, sensor=True),
    "{angle}_sensor.quantization": Entry("quantization of {angle}", formulas.same("q"), sensor=True),
    "{angle}_sensor.delay": Entry("delay of {angle}", formulas.same("tau"), sensor=True),
    "{angle}_sensor.lag": Entry("lag of {angle}", formulas.same("tau"), sensor=True),
    "{angle}_sensor.backlash": Entry("backlash of {angle}", formulas.same("width"), sensor=True),
    "loop.delay": Entry("delay of u_M and u_T", formulas.same("tau")),
    "loop.dropped_frames": Entry("lost updates of u_M and u_T", formulas.same("p")),
}


def in_table(
    name: str,
    size: Size,
    *indices: int,
    law: OwnLaw | None = None,
    **traits: Unpack[Traits],
) -> Effect:
    """A rig's row of the contract's table: `name` as there, words in braces those of the first of `indices` (none: no pair).

    `law`: the rig's own formula; `equivalent` stands in place of the table's.
    """
    entry = TABLE[name]
    words = WORDS[indices[0]] if indices else {}
    own: Traits = {**traits, "sensor": entry.sensor, "needs": entry.needs}
    told = (name.format(**words), entry.depends.format(**words))
    return known(*told, size, entry.formula, *indices, law=law, **own)


def outside_table(
    name: str,
    places: str,
    depends: str,
    size: Size,
    *indices: int,
    keywords: str = "",
    twins: str = "",
    **traits: Unpack[Traits],
) -> Effect:
    """A rig's row of an effect that the contract's table does not hold; lists of words are one text, words in braces as in the table."""
    words = WORDS[indices[0]] if indices else {}
    told = (name.format(**words), places.format(**words), depends.format(**words))
    return outside(*told, size, *indices, keywords=keywords, twins=twins.format(**words), **traits)


def for_both(*rows: Callable[[int], tuple[Effect, ...]]) -> tuple[Effect, ...]:
    """All rows of index 0, then all of index 1."""
    return tuple(effect for index in (0, 1) for rows_of in rows for effect in rows_of(index))
