"""Edges of an encoder that are lost in the noise of the current beside it.

(1)  y = angle - a m,   m' = |x| / X angle'

x is the speed of the rotor that drives the axis, or its input where the speed is no state, and X the largest. Each edge is missed with the
probability a |x| / X, as what a motor draws grows with its speed; eq (1) is the mean. m, how far the axis went weighted so, has nothing
of a in it, so that of no size the effect leaves the reading alone whatever is known of m.
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, short, speed_name, with_output, with_state
from sim.effect import Effect, EffectParameter
from sim.model import Model, symbol


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each sensor of an axis that a rotor is there to turn."""
    axes = {entry.angle: axis for axis, entry in model.places.axes.items()}
    for place, entry in model.places.sensors.items():
        axis = axes.get(entry.output, "")
        rotor = model.places.rotors.get(model.places.rotor_of(axis))
        if rotor is None:
            continue
        angle = short(entry.output)
        turns = rotor.drive is not None
        x = f"omega_{rotor.letter}" if turns else str(rotor.variable)
        largest = rotor.speed_size if turns else rotor.input_size
        share = sympy.Abs(rotor.speed if turns else rotor.variable) / largest
        yield Effect(
            name=f"{place}.missed_counts",
            depends=f"output({angle}, {x}) of {angle}",
            parameters=(EffectParameter("a", "-", 0.0, 0.5, 0.02, 0.0),),
            equation=f"y = angle - a m, m' = |{x}|/{largest:g} {speed_name(model, axis)}",
            story="The motor's current disturbs the encoder beside it: the harder the rotor works, the more counts are missed.",
            source="interference of a driver's switching with an encoder's edges",
            edit=lambda model, a, axis=axis, share=share: _edit(model, a, axis, share),
            twins={f"{place}.scale": "at a nearly constant input, a constant share of the counts is missed"},
        )


def _edit(model: Model, a: sympy.Symbol, axis: str, share: sympy.Expr) -> Model:
    place = model.places.axes[axis]
    m = symbol(f"missed_{axis}_{place.length_unit}")
    model = with_state(model, m, share * axis_of(model, axis).velocity)
    return with_output(model, place.angle, lambda output: output - a * m)
