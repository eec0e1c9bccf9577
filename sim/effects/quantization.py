"""Steps: a driver or a sensor that knows only multiples of q.

(1)  q round(x / q)

A driver's may lie beside the multiples by a share s of a step, as a converter that cuts off has them half a step away; and it may hold a
step until its command is further away than half of one, as a comparator with hysteresis does:

(2)  v stays while abs(u - v) <= (1/2 + h) q, else v = q (round(u / q + s) - s)
"""

from collections.abc import Iterator

from sim.edits import short
from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.paths.input_stages import Quantised
from sim.paths.output_stages import OutputSteps
from sim.places import InputPlace, SensorPlace
from sim.prior import COMMON

INPUT_STEPS = (0.005, 0.01, 0.02, 0.04, 0.08)
HOLDS = (0.0, 0.12)  # shares of a step: a converter has none, of a comparator any size is near one of both
SHIFTS = (0.0, 0.25, 0.5, -0.25)  # shares of a step: any lies within an eighth of one of them
OUTPUT_STEPS = (0.003, 0.006, 0.012, 0.025)


def effects(model: Model) -> Iterator[Effect]:
    """Eq (2) on each input, eq (1) on each sensor."""
    for place, entry in model.places.inputs.items():
        yield _of_driver(model, place, entry)
    for place, sensor in model.places.sensors.items():
        yield _of_sensor(model, place, sensor)


def _of_driver(model: Model, place: str, entry: InputPlace) -> Effect:
    column, size = model.inputs.index(entry.variable), entry.size
    return Effect(
        name=f"{place}.quantization",
        depends=f"steps of {entry.variable}",
        parameters=(
            EffectParameter(
                "q",
                entry.unit,
                0.0,
                0.3 * size,
                0.02 * size,
                0.0,
                tuple(s * size for s in INPUT_STEPS),
                role=Role.STEP,
                rough=True,
            ),
            EffectParameter("h", "1", 0.0, 0.3, 0.0, starts=HOLDS, refining=True, role=Role.HOLD, rough=True),
            EffectParameter("s", "1", -0.5, 0.5, 0.0, starts=SHIFTS, refining=True, role=Role.SHIFT, rough=True),
        ),
        equation="q (round(u/q + s) - s), held within (1/2 + h) q",
        story="The driver knows only coarse steps of voltage.",
        source="a converter's or PWM's resolution; a comparator's hysteresis",
        prior=COMMON,
        on_input=lambda values: Quantised(column, values["q"], values.get("h", 0.0), values.get("s", 0.0)),
        smooth=False,
    )


def _of_sensor(model: Model, place: str, sensor: SensorPlace) -> Effect:
    output, size = [*model.outputs].index(sensor.output), sensor.size
    return Effect(
        name=f"{place}.quantization",
        depends=f"steps of {short(sensor.output)}",
        parameters=(
            EffectParameter(
                "q",
                sensor.unit,
                0.0,
                0.2 * size,
                0.006 * size,
                0.0,
                tuple(s * size for s in OUTPUT_STEPS),
                role=Role.STEP,
            ),
        ),
        equation="y = q round(angle/q)",
        story="The sensor's steps are coarser than stated.",
        source="an encoder's resolution",
        prior=COMMON,
        on_output=lambda values: OutputSteps(output, values["q"]),
        smooth=False,
    )
