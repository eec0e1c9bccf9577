"""Torques by which a rotor acts on the axis that it is not there to turn.

(1)  tilting axis + k omega_T |omega_T|             a tail rotor that does not stand square
(2)  level axis - k omega_M |omega_M| cos(Psi)      the air's drag on the main rotor goes with the square of its speed
(3)  axis - J d(omega)/dt                           what speeds a rotor up turns the body the other way (cos(Psi) on the level axis)
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, RARE


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) where there are both rotors, (3) where their speeds are states."""
    level, tilting = model.places.level, model.places.tilting
    if not level:
        return
    yield from _coupling(model, level, tilting)
    for axis, entry in model.places.axes.items():
        if not entry.spun_by:
            continue
        rotor = model.places.rotors[entry.spun_by]
        if rotor.speed not in model.states:
            continue
        size = 0.3 * entry.torque_size / 600.0
        yield Effect(
            name=f"{axis}.rotor_acceleration",
            depends=f"torque(domega_{rotor.letter}/dt)",
            parameters=(EffectParameter("J", f"{entry.torque_unit} s^2", -20.0 * size, 20.0 * size, size, 0.0),),
            equation=f"- J d(omega_{rotor.letter})/dt" + (" cos(Psi)" if axis == level else ""),
            story="Revving a rotor up turns the arm the other way for a moment.",
            source="conservation of angular momentum",
            prior=COMMON,
            edit=lambda model, J, axis=axis: _accelerating(model, J, axis),
            twins={f"{axis}.flexible_mode": "both answer to fast changes of a rotor's speed"},
        )


def _coupling(model: Model, level: str, tilting: str) -> Iterator[Effect]:
    entry, main, tail = model.places.axes[tilting], model.places.lifting, model.places.turning
    for axis, place, sign, twin in ((tilting, tail, 1, "tail_gyroscopic"), (level, main, -1, "")):
        if not (main and tail):
            continue
        rotor = model.places.rotors[place]
        size = 0.1 * entry.torque_size / rotor.speed_size**2
        yield Effect(
            name=f"{axis}.{'tail_coupling' if sign > 0 else 'quadratic_reaction'}",
            depends=f"torque(omega_{rotor.letter})",
            parameters=(EffectParameter("k", f"{entry.torque_unit} s^2", -20.0 * size, 20.0 * size, size, 0.0),),
            equation=f"{'+' if sign > 0 else '-'} k omega_{rotor.letter} |omega_{rotor.letter}|"
            + (" cos(Psi)" if sign < 0 else ""),
            story="The tail rotor does not stand square and lifts the arm a little."
            if sign > 0
            else "The air's drag on the main rotor turns the arm, more than in proportion to its speed.",
            source="a share of the tail rotor's thrust"
            if sign > 0
            else "blade element theory: drag torque goes with the square",
            prior=COMMON if sign > 0 else RARE,
            edit=lambda model, k, axis=axis, place=place, sign=sign: _pushed(model, sign * k, axis, place),
            twins={f"{axis}.{twin}": "both carry the tail rotor's speed to the elevation"}
            if twin
            else {
                f"{tail}.downwash": "at a constant tail speed both are a torque that grows with the main rotor's speed"
            },
        )


def _pushed(model: Model, k: sympy.Expr, axis: str, place: str) -> Model:
    speed = model.places.rotors[place].speed
    return with_torque(model, axis, k * speed * sympy.Abs(speed) * _lever(model, axis))


def _accelerating(model: Model, J: sympy.Symbol, axis: str) -> Model:
    rotor = model.places.rotors[model.places.axes[axis].spun_by]
    rotor_axes = {entry.velocity: entry.torque for entry in model.axes if entry.position is None}
    rate = rotor_axes.get(rotor.speed, model.rates.get(rotor.speed))
    return with_torque(model, axis, -J * rate * _lever(model, axis))


def _lever(model: Model, axis: str) -> sympy.Expr:
    """cos(Psi) on the level axis, as for the model's own reaction torque."""
    return sympy.cos(axis_of(model, model.places.tilting).position) if axis == model.places.level else sympy.Integer(1)
