"""What swings as a sine of an angle or of time.

(1)  y = angle + amplitude sin(waves angle + phase)      a sensor's disc or magnet that is not round
(2)  torque + amplitude sin(waves angle + phase)         a motor, a gear or a bearing with so many teeth a turn
(3)  torque + amplitude sin(rate t + phase)              something that turns nearby; t is the log's clock

Waves too long to be told from a scale, a spring or a tilt are none of these.
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, short, with_output, with_position, with_torque
from sim.effect import Effect, EffectParameter, Role
from sim.model import TIME, Model
from sim.places import AxisPlace, SensorPlace
from sim.prior import NOTHING_NEW, Unlikely

FEWEST, MOST = 3.5, 64.0  # waves a turn, or in the place of 2 pi of an axis' usual way
PHASE = EffectParameter("phase", "rad", -50.0, 50.0, 0.0, role=Role.PHASE)
ROUNDING = Unlikely(
    NOTHING_NEW, "at a steady speed rounding beats with the samples, which swings with the angle too", steps=0.5
)


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each encoder, (2) and (3) on each axis."""
    for place, sensor in model.places.encoders.items():
        yield _cyclic(place, sensor)
    for axis, entry in model.places.axes.items():
        if axis in with_position(model):
            yield _detent(model, axis, entry)
        yield _periodic(axis, entry)


def _cyclic(place: str, sensor: SensorPlace) -> Effect:
    angle, size = short(sensor.output), sensor.size
    return Effect(
        name=f"{place}.cyclic",
        depends=f"output({angle}) of {angle}",
        parameters=(
            EffectParameter("amplitude", sensor.unit, -0.2 * size, 0.2 * size, 0.005 * size, 0.0, unlikely=ROUNDING),
            _waves(sensor.unit, size),
            PHASE,
        ),
        equation="y = angle + amplitude sin(waves angle + phase)",
        story="The sensor reads too much and too little by turns as the axis moves: its disc or magnet is not round.",
        source="an encoder's eccentric disc, interpolation between its lines",
        edit=lambda model, amplitude, waves, phase: with_output(
            model, sensor.output, lambda output: output + amplitude * sympy.sin(waves * output + phase)
        ),
    )


def _detent(model: Model, axis: str, entry: AxisPlace) -> Effect:
    angle, unit, size = short(entry.angle), entry.length_unit, entry.torque_size
    length = next((sensor.size for sensor in model.places.sensors.values() if sensor.output == entry.angle), 1.0)
    return Effect(
        name=f"{axis}.detent",
        depends=f"torque({angle})",
        parameters=(
            EffectParameter("amplitude", entry.torque_unit, -size, size, 0.05 * size, 0.0),
            _waves(unit, length),
            PHASE,
        ),
        equation=f"+ amplitude sin(waves {angle} + phase)",
        story="The axis is pulled towards places at equal distances, as by magnets or teeth.",
        source="a motor's cogging torque, a gear's teeth",
        edit=lambda model, amplitude, waves, phase: with_torque(
            model, axis, amplitude * sympy.sin(waves * axis_of(model, axis).position + phase)
        ),
    )


def _periodic(axis: str, entry: AxisPlace) -> Effect:
    size = entry.torque_size
    return Effect(
        name=f"{axis}.periodic_torque",
        depends="torque(t)",
        parameters=(
            EffectParameter("amplitude", entry.torque_unit, -size, size, 0.05 * size, 0.0),
            EffectParameter("rate", "rad s^-1", 0.3, 100.0, 5.0, starts=(2.0, 5.0, 10.0), role=Role.RATE),
            PHASE,
        ),
        equation="+ amplitude sin(rate t + phase)",
        story="Something pushes the axis to and fro at its own steady pace, whatever the rig does.",
        source="a fan's draught, a machine on the same table",
        edit=lambda model, amplitude, rate, phase: with_torque(model, axis, amplitude * sympy.sin(rate * TIME + phase)),
        twins={f"{axis}.flexible_mode": "both swing at one frequency"},
    )


def _waves(unit: str, length: float) -> EffectParameter:
    """How many radians of the sine go on one unit of the way."""
    return EffectParameter(
        "waves",
        f"rad {unit}^-1",
        FEWEST / length,
        MOST / length,
        10.0 / length,
        starts=(6.0 / length, 12.0 / length),
        role=Role.WAVES,
    )
