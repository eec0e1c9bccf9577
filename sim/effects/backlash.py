"""Play in the gear or coupling of a sensor.

(1)  y moves with the angle only when the play `width` is used up
"""

from collections.abc import Iterator

from sim.effects.edits import short
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model
from sim.paths_output import Play


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each sensor."""
    for output, (place, sensor) in enumerate(model.places.sensors.items()):
        size = sensor.size
        grid = tuple(share * size for share in (0.003, 0.01, 0.03))
        yield Effect(
            name=f"{place}.backlash",
            depends=f"play of {short(sensor.output)}",
            parameters=(EffectParameter("width", sensor.unit, 0.0, 0.3 * size, 0.006 * size, 0.0, grid),),
            equation="y follows the angle through a play of the given width",
            story="The encoder's coupling has play: after a reversal it stands still for a moment.",
            source="play operator",
            on_output=lambda values, output=output: Play(output, values["width"]),
            smooth=False,
            twins={f"{place}.quantization": "both hold the reading still near a reversal"},
        )
