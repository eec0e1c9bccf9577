"""Play in the gear or coupling of a sensor, or in a driver.

(1)  y moves with the angle only when the play `width` is used up
(2)  the driver's input likewise with its command
"""

from collections.abc import Iterator

from sim.edits import short
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.paths.input_stages import InputPlay
from sim.paths.output_stages import Play
from sim.prior import COMMON, RARE


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each encoder, (2) on each input."""
    for place, sensor in model.places.sensors.items():
        output = [*model.outputs].index(sensor.output)
        if place not in model.places.encoders:
            continue
        size = sensor.size
        grid = tuple(share * size for share in (0.003, 0.01, 0.03, 0.1))
        yield Effect(
            name=f"{place}.backlash",
            depends=f"play of {short(sensor.output)}",
            parameters=(EffectParameter("width", sensor.unit, 0.0, 0.3 * size, 0.006 * size, 0.0, grid),),
            equation="y follows the angle through a play of the given width",
            story="The sensor's coupling has play: after a reversal it stands still for a moment.",
            source="play operator",
            prior=COMMON,
            on_output=lambda values, output=output: Play(output, values["width"]),
            smooth=False,
            twins={f"{place}.quantization": "both hold the reading still near a reversal"},
        )
    for place, entry in model.places.inputs.items():
        column = model.inputs.index(entry.variable)
        size = entry.size
        grid = tuple(share * size for share in (0.01, 0.03, 0.1))
        yield Effect(
            name=f"{place}.backlash",
            depends=f"play of {entry.variable}",
            parameters=(EffectParameter("width", entry.unit, 0.0, 0.5 * size, 0.02 * size, 0.0, grid),),
            equation=f"{entry.variable} follows its command through a play of the given width",
            story="The driver lets small changes pass by: its output moves only when the command has gone far enough.",
            source="hysteresis of a driver, a worn potentiometer",
            prior=RARE,
            on_input=lambda values, column=column: InputPlay(column, values["width"]),
            smooth=False,
        )
