"""A sensor whose zero, scale, mounting or count is off.

(1)  y = angle + offset
(2)  y = scale angle
(3)  y = angle + eps other angle             the two axes do not stand square to one another
(4)  y = angle + jump from the time t_s on    counts lost or gained at once
"""

from collections.abc import Iterator

from sim.edits import short, step, with_output
from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.places import SensorPlace
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) on each sensor, (4) on each encoder, (3) where there are two."""
    for place, entry in model.places.sensors.items():
        yield from _one(place, entry)
        if place in model.places.encoders:
            yield _slipped(place, entry)
        other = next((name for name in model.outputs if name != entry.output), None)
        if other is not None and len(model.places.sensors) > 1:
            yield _crossed(place, entry, other)


def _one(place: str, entry: SensorPlace) -> Iterator[Effect]:
    y, unit, size = entry.output, entry.unit, entry.size
    angle = short(y)
    yield Effect(
        name=f"{place}.offset",
        depends=f"output(1) of {angle}",
        parameters=(EffectParameter("offset", unit, -0.5 * size, 0.5 * size, 0.02 * size, 0.0),),
        equation="y = angle + offset",
        story="The sensor's zero is not where the model thinks it is.",
        source="an encoder's index",
        prior=COMMON,
        edit=lambda model, offset: with_output(model, y, lambda output: output + offset),
    )
    yield Effect(
        name=f"{place}.scale",
        depends=f"output({angle}) of {angle}",
        parameters=(EffectParameter("scale", "-", 0.5, 1.5, 1.03, 1.0),),
        equation="y = scale angle",
        story="The sensor reads a constant share too much or too little.",
        source="a wrong count per turn",
        prior=COMMON,
        edit=lambda model, scale: with_output(model, y, lambda output: scale * output),
        twins={
            f"{place}.missed_counts": "at a nearly constant input, a constant share of the counts is missed",
            "parameters": "where nothing depends on the true angle, inertia, friction and thrust scale along with it",
        },
    )


def _slipped(place: str, entry: SensorPlace) -> Effect:
    y, size = entry.output, entry.size
    return Effect(
        name=f"{place}.count_slip",
        depends=f"output(t) of {short(y)}",
        parameters=(
            EffectParameter("jump", entry.unit, -size, size, 0.04 * size, 0.0, role=Role.JUMP),
            EffectParameter("t_s", "s", 0.0, 1.0e5, 10.0, role=Role.INSTANT),
        ),
        equation="y = angle + jump for t > t_s",
        story="The encoder lost or gained counts at one moment and reads wrong by them ever after.",
        source="lost counts",
        edit=lambda model, jump, t_s: with_output(model, y, lambda output: output + jump * step(t_s)),
        smooth=False,
    )


def _crossed(place: str, entry: SensorPlace, other: str) -> Effect:
    return Effect(
        name=f"{place}.cross_alignment",
        depends=f"output({short(other)}) of {short(entry.output)}",
        parameters=(EffectParameter("eps", "-", -0.3, 0.3, 0.02, 0.0),),
        equation=f"y = angle + eps {short(other)}",
        story="The two axes do not stand square: turning one also turns the other's sensor a little.",
        source="small-angle geometry of two axes",
        edit=lambda model, eps: with_output(model, entry.output, lambda output: output + eps * model.outputs[other]),
    )
