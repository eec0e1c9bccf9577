"""A driver whose gain or zero is off.

(1)  u -> gain u, of one input or of all that one battery feeds
(2)  u -> u + offset
"""

from collections.abc import Iterator

from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import RARE, Prior

OWN = Prior(-3.0, "rigs of this kind are known for it, but it is a parameter of the plant under another name")


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) on each input, (1) on all together where there are several."""
    for place, entry in model.places.inputs.items():
        u = entry.variable
        yield Effect(
            name=f"{place}.gain",
            depends=f"gain of {u}",
            parameters=(EffectParameter("gain", "-", 0.2, 3.0, 0.9, 1.0),),
            equation=f"{u} -> gain {u}",
            story="The driver gives a constant share more or less than it is told, as with another battery voltage.",
            source="a driver's calibration",
            prior=OWN,
            applied=lambda gain, u=u: {u: gain * u},
            twins={
                f"{model.places.driven_by(u)}.warmup": "once warm, the drive is down by a constant share",
                f"parameters of {model.places.driven_by(u)}": "identical: the gain from input to torque is one number",
                "loop.gain": "the battery's gain is that of all inputs together",
            },
        )
        yield Effect(
            name=f"{place}.offset",
            depends=f"offset of {u}",
            parameters=(
                EffectParameter("offset", entry.unit, -0.2 * entry.size, 0.2 * entry.size, 0.02 * entry.size, 0.0),
            ),
            equation=f"{u} -> {u} + offset",
            story="The driver's zero is off: the plant is pushed a little even when it is told nothing.",
            source="a driver's calibration",
            prior=RARE,
            applied=lambda offset, u=u: {u: u + offset},
            twins={f"{place}.deadzone": "while the input keeps its sign, both add or take away a constant"},
        )
    if len(model.places.inputs) > 1:
        yield _battery(model)


def _battery(model: Model) -> Effect:
    inputs = {place: entry.variable for place, entry in model.places.inputs.items()}
    names = " and ".join(map(str, inputs.values()))
    return Effect(
        name="loop.gain",
        depends=f"gain of {names}",
        parameters=(EffectParameter("gain", "-", 0.2, 3.0, 0.9, 1.0),),
        equation="u -> gain u, every input",
        story="All drivers give the same constant share more or less than they are told, as on another battery.",
        source="one supply feeds all drivers",
        prior=OWN,
        applied=lambda gain: {u: gain * u for u in inputs.values()},
        twins={
            **{f"{place}.gain": "together they are the battery's gain" for place in inputs},
            "parameters": "identical: the gain from each input to its torque is one number",
        },
    )
