"""Where an effect can act: the places of a plant, with the parts of its equations that belong to each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import sympy

from records.text.units import unit_suffix

Edit = Callable[[sympy.Expr], sympy.Expr]


@dataclass(frozen=True)
class InputPlace:
    """The driver of one input: its symbol, its unit and the largest command [unit]."""

    variable: sympy.Symbol
    unit: str
    size: float


@dataclass(frozen=True)
class RotorPlace:
    """A rotor or motor driven by the input `variable`.

    `speed` is its speed (a state, or an expression of the input where it has no lag), about `speed_size` at full input, and `letter`
    its index in the equations. `thrusts` are its torques (forces) by axis. `drive` is the part of the speed's rate that the input
    makes; None where the speed is no state.
    """

    variable: sympy.Symbol
    letter: str
    speed: sympy.Expr
    speed_size: float
    thrusts: Mapping[str, sympy.Expr]
    input_size: float
    drive: sympy.Expr | None = None
    linear: bool = False  # the thrust is proportional to the input
    two_way: bool = False  # the input takes both signs


@dataclass(frozen=True)
class AxisPlace:
    """A mechanical axis: what a typical torque (force) and speed on it are, their units, and gravity's torque if it has one.

    `gravity_moment` is the factor of `gravity` that a moved balance weight changes; `vertical` is an axis that gravity turns about,
    `level` one that it does not, as long as the base is level. `length_unit` is that of the angle's name where nothing else is said.
    """

    angle: str
    torque_unit: str
    torque_size: float
    length_unit: str = ""
    speed_size: float = 1.0
    gravity: sympy.Expr | None = None
    gravity_moment: sympy.Expr | None = None
    level: bool = False
    spun_by: str = ""  # the rotor whose acceleration turns this axis the other way

    def __post_init__(self) -> None:
        if not self.length_unit:
            object.__setattr__(self, "length_unit", "m" if unit_suffix(self.angle) == "m" else "rad")


@dataclass(frozen=True)
class SensorPlace:
    """The sensor of one output, with the output's unit and a typical range."""

    output: str
    unit: str
    size: float = 1.0


@dataclass(frozen=True)
class Places:
    """All places of a plant by name, grouped by kind; `loop` is the timing that all inputs share."""

    inputs: Mapping[str, InputPlace] = field(default_factory=dict)
    rotors: Mapping[str, RotorPlace] = field(default_factory=dict)
    axes: Mapping[str, AxisPlace] = field(default_factory=dict)
    sensors: Mapping[str, SensorPlace] = field(default_factory=dict)
    loop: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Every place's name, along the signal's way."""
        return (*self.inputs, *self.rotors, *self.axes, *self.sensors, *(("loop",) if self.loop else ()))

    @property
    def level(self) -> str:
        """The axis that gravity does not turn (azimuth, yaw) beside one that it does; "" where there is none."""
        return next((name for name, axis in self.axes.items() if axis.level), "")

    @property
    def tilting(self) -> str:
        """The axis that gravity turns (elevation, pitch), whose angle the level axis' lever depends on; "" where there is none."""
        return next((name for name, axis in self.axes.items() if not axis.level), "") if self.level else ""

    @property
    def encoders(self) -> Mapping[str, SensorPlace]:
        """The sensors that read the way of an axis: they have a disc, a coupling and a count, as one of a current or of a speed has not."""
        ways = {(axis.angle, axis.length_unit) for axis in self.axes.values()}
        return {name: sensor for name, sensor in self.sensors.items() if (sensor.output, sensor.unit) in ways}

    def driven_by(self, variable: sympy.Symbol) -> str:
        """The rotor that an input drives; "" where none is declared."""
        return next((name for name, rotor in self.rotors.items() if rotor.variable == variable), "")

    def rotor_of(self, axis: str) -> str:
        """The rotor that is there to turn an axis; "" where none is declared."""
        return next((rotor for rotor in self.rotors if self.pushed_by(rotor) == axis), "")

    @property
    def lifting(self) -> str:
        """The rotor that is there to turn the tilting axis, a helicopter's main rotor; "" where none is declared."""
        return self.rotor_of(self.tilting)

    @property
    def turning(self) -> str:
        """The rotor that is there to turn the level axis, a helicopter's tail rotor; "" where none is declared."""
        return self.rotor_of(self.level)

    def input_of(self, rotor: str) -> str:
        """The input that drives a rotor; "" where none is declared."""
        return next((name for name, entry in self.inputs.items() if entry.variable == self.rotors[rotor].variable), "")

    def pushed_by(self, rotor: str) -> str:
        """The axis that a rotor is there to turn: the first that it pushes, the level one for a tail rotor."""
        return self.level if rotor == "tail_rotor" else next(iter(self.rotors[rotor].thrusts))

    def edited(self, edit: Edit) -> "Places":
        """The same places with `edit` done to every expression."""
        return replace(
            self,
            rotors={name: _edited_rotor(rotor, edit) for name, rotor in self.rotors.items()},
            axes={
                name: replace(axis, gravity=None if axis.gravity is None else edit(axis.gravity))
                for name, axis in self.axes.items()
            },
        )


def _edited_rotor(rotor: RotorPlace, edit: Edit) -> RotorPlace:
    return replace(
        rotor,
        speed=edit(rotor.speed),
        thrusts={axis: edit(torque) for axis, torque in rotor.thrusts.items()},
        drive=None if rotor.drive is None else edit(rotor.drive),
    )
