"""What the turning main rotor and the two turning axes do to one another and the model leaves out.

(1)  level axis:   - K Psi' omega_M sin(Psi)          the reciprocal of the gyroscopic torque on the other axis
(2)  level axis:   + c sin(2 Psi) Psi' Phi'           Coriolis, the reciprocal of the centrifugal torque
(3)  tilting axis: + c Phi'^2 sin(2 Psi)              centrifugal torque beside the model's
(4)  tilting axis: + K omega_T Phi'                   gyroscopic torque of the tail rotor
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, short, speed_name, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) to (4) where one axis sits on the other."""
    if model.places.level:
        yield from _on_level_axis(model, model.places.level, model.places.tilting)
        yield from _on_tilting_axis(model, model.places.level, model.places.tilting)


def _on_level_axis(model: Model, level: str, tilting: str) -> Iterator[Effect]:
    main = model.places.lifting
    over, base = model.places.axes[tilting], model.places.axes[level]
    psi, psi_dot, phi_dot = short(over.angle), speed_name(model, tilting), speed_name(model, level)
    size = base.torque_size
    spin, unit = 0.3 * size / 600.0, f"{base.torque_unit} s^2"
    letter = model.places.rotors[main].letter if main else ""
    if main:
        yield Effect(
            name=f"{level}.gyroscopic",
            depends=f"torque({psi_dot}, omega_{letter}, {psi})",
            parameters=(EffectParameter("K", unit, -50.0 * spin, 50.0 * spin, spin, 0.0),),
            equation=f"- K {psi_dot} omega_{letter} sin({psi})",
            story="Tipping the fast main rotor kicks the arm sideways, as a spinning top would.",
            source="reciprocal of a term in seed 000 eq (8)",
            prior=COMMON,
            edit=lambda model, K: with_torque(
                model, level, -K * _rate(model, tilting) * _speed(model, main) * sympy.sin(_angle(model, tilting))
            ),
            twins={f"{level}.coriolis": "both show when both axes move"},
        )
    yield Effect(
        name=f"{level}.coriolis",
        depends=f"torque({psi}, {psi_dot}, {phi_dot})",
        parameters=(EffectParameter("c", unit, -size, size, 0.05 * size, 0.0),),
        equation=f"+ c sin(2 {psi}) {psi_dot} {phi_dot}",
        story="Pulling the arm in while it turns makes it turn faster, as a skater does.",
        source="Lagrange: reciprocal of the centrifugal term in seed 000 eq (8)",
        said="Coriolis torque",
        edit=lambda model, c: with_torque(
            model, level, c * sympy.sin(2 * _angle(model, tilting)) * _rate(model, tilting) * _rate(model, level)
        ),
        twins={f"{level}.inertia_shape": "both make the azimuth's inertia depend on the elevation"},
    )


def _on_tilting_axis(model: Model, level: str, tilting: str) -> Iterator[Effect]:
    tail = model.places.turning
    over, base = model.places.axes[tilting], model.places.axes[level]
    psi, phi_dot = short(over.angle), speed_name(model, level)
    size = base.torque_size
    spin, unit = 0.3 * size / 600.0, f"{base.torque_unit} s^2"
    yield Effect(
        name=f"{tilting}.centrifugal",
        depends=f"torque({phi_dot}, {psi})",
        parameters=(EffectParameter("c", unit, -size, size, 0.05 * size, 0.0),),
        equation=f"+ c {phi_dot}^2 sin(2 {psi})",
        story="Turning fast throws the arm towards the horizontal, with another strength than the model says.",
        source="seed 000 eq (8), whose factor and sign are doubtful",
        edit=lambda model, c: with_torque(
            model, tilting, c * _rate(model, level) ** 2 * sympy.sin(2 * _angle(model, tilting))
        ),
    )
    if tail:
        letter = model.places.rotors[tail].letter
        yield Effect(
            name=f"{tilting}.tail_gyroscopic",
            depends=f"torque(omega_{letter}, {phi_dot})",
            parameters=(EffectParameter("K", unit, -50.0 * spin, 50.0 * spin, spin, 0.0),),
            equation=f"+ K omega_{letter} {phi_dot}",
            story="Turning the arm with the tail rotor spinning tips it up or down.",
            source="Euler's equations",
            edit=lambda model, K: with_torque(model, tilting, K * _speed(model, tail) * _rate(model, level)),
            twins={f"{tilting}.tail_coupling": "both carry the tail rotor's speed to the elevation"},
        )


def _angle(model: Model, axis: str) -> sympy.Expr:
    return axis_of(model, axis).position


def _rate(model: Model, axis: str) -> sympy.Expr:
    return axis_of(model, axis).velocity


def _speed(model: Model, rotor: str) -> sympy.Expr:
    return model.places.rotors[rotor].speed
