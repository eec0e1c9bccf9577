"""Edges of an encoder that are lost in the noise of the current beside it.

(1)  y = angle - a m,   m' = |u| / U angle',   u the input that drives the axis, U the largest

Each edge is missed with the probability a |u| / U; eq (1) is the mean. m, how far the axis went weighted by the current, has nothing of
a in it, so that of no size the effect leaves the reading alone whatever is known of m.
"""

from collections.abc import Iterator

import sympy

from sim.effects.edits import axis_of, short, with_output, with_state
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model, symbol


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each sensor of an axis that a rotor is there to turn."""
    axes = {entry.angle: axis for axis, entry in model.places.axes.items()}
    for place, entry in model.places.sensors.items():
        axis = axes.get(entry.output, "")
        rotor = model.places.rotors.get(model.places.rotor_of(axis))
        if rotor is None:
            continue
        u, angle = rotor.variable, short(entry.output)
        share = sympy.Abs(u) / rotor.input_size
        yield Effect(
            name=f"{place}.missed_counts",
            depends=f"output({angle}, {u}) of {angle}",
            parameters=(EffectParameter("a", "-", 0.0, 0.5, 0.02, 0.0),),
            equation=f"y = angle - a m, m' = |{u}|/{rotor.input_size:g} {angle}'",
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
