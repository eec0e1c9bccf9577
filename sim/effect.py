"""What an effect is: physics that a rig may have and its model lacks."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

import sympy

from sim.model import Model, ParameterSpec
from sim.paths.path import InputStage, OutputStage
from sim.prior import RARE, Prior, Unlikely

Values = Mapping[str, float]
TOUCH = 1e-9


class Role(Enum):
    """What a number of a formula is: by it, not by a name, a diagnosis knows how to look for it. One of each in an effect at most.

    NUMBER is found by its slopes from its `starts`, as most are. An effect with an INSTANT is an event: instants, and the DURATION of
    what ends, are found from the answers to steps in time. One with a PHASE swings: RATE (rad/s) or WAVES (rad a unit of the way) are
    found from the answers to sines. The others: see each.
    """

    NUMBER = "nothing further"
    INSTANT = "when it happens, s from the log's beginning"
    DURATION = "how long it lasts, s"
    BEGINNING = "when it begins, s: known, the beginning of the earliest log that is run"
    RATE = "how fast a sine goes in time"
    WAVES = "how often a sine goes on the way"
    PHASE = "where a sine begins"
    DIRECTION = "where something points to: half a turn on, a size of the other sign is the same"
    LATENESS = "by how much a signal is late, s"
    JITTER = (
        "by how much lateness scatters, s: found by the likelihood, as readings that are less sure have no slope by it"
    )
    STEP = (
        "the step of a grid: on a sensor read off the readings, on an input found from the answers to rounding errors"
    )
    HOLD = "by how much of a step it is held beyond its half: tried with each step"
    SHIFT = "where the steps lie, as a share of one: tried with each step"
    JUMP = "a jump of a reading by counts: less than a count is none"
    LEVEL = "an input's largest size: nothing happens below it, so it is tried at shares of the largest command"
    SLOPE = "an input's largest rate: nothing happens below it"
    LOSS = "the share of commands that are lost, each run other ones: found from the answers to each frame's loss"
    STRENGTH = "standard deviation of what is random, each run anew: found by the likelihood beside MEMORY"
    MEMORY = "correlation time of what is random, s"


LIMITS = (Role.LEVEL, Role.SLOPE)


@dataclass(frozen=True)
class EffectParameter:
    """A number of an effect's formula, under the formula's symbol.

    `zero` is the value at which the effect vanishes, None for a number that only shapes it; `reference` is a size that one may meet
    on such a rig. `starts` are the values from which a fit begins where one is not enough; all lie within [lower, upper]. One that is
    `refining` is 0 in the effect's plain formula, and a plant file may leave it out. Where `rough`, the likelihood by it has too many
    tops for slopes: a fit tries values beside it, and the choice of a size among them costs evidence. `unlikely` values make another cause
    of what fits.
    """

    symbol: str
    unit: str
    lower: float
    upper: float
    reference: float
    zero: float | None = None
    starts: tuple[float, ...] = ()
    refining: bool = False
    role: Role = Role.NUMBER
    rough: bool = False
    unlikely: Unlikely | None = None

    def at_pace(self, second_s: float) -> "EffectParameter":
        """The same of a plant that takes `second_s` for what others do in a second: times are so much longer, rates so much less. Instants
        are those of the logs."""
        factor = second_s if self.unit == "s" else 1.0 / second_s if self.role is Role.SLOPE else 1.0
        if factor == 1.0 or self.role in (Role.INSTANT, Role.BEGINNING):
            return self
        moved = {name: factor * getattr(self, name) for name in ("lower", "upper", "reference")}
        zero = None if self.zero is None else factor * self.zero
        return replace(self, **moved, zero=zero, starts=tuple(factor * start for start in self.starts))

    @property
    def is_size(self) -> bool:
        """Whether the effect vanishes with it."""
        return self.zero is not None

    @property
    def first(self) -> float:
        """Where an absent effect stands: no size, a middling shape."""
        return self.reference if self.zero is None else self.zero

    @property
    def touched(self) -> float:
        """`first`, with a size a billionth of the way towards its reference."""
        return self.first + TOUCH * (self.reference - self.first)


@dataclass(frozen=True)
class FilterState:
    """The state by which a filter carries what a simulation carries otherwise: on the way of a signal, or as one draw of many.

    edit(model, on, *symbols) is the model with the state `name`, without anything of it where the switch `on` is 0. It begins at 0, or
    where the output that it `follows` is first read. One that noise drives has noise(values) -> intensity of the noise on its rate
    [unit^2/s], and its variance [unit^2] at the start.
    """

    name: str
    edit: Callable[..., Model]
    follows: str = ""
    noise: Callable[[Values], tuple[float, float]] | None = None


@dataclass(frozen=True, eq=False)
class Effect:
    """One effect at one place of one plant.

    `depends` and `place` make the class ("torque(phi) on azimuth"): what the missing term depends on and where it acts. `equation` is
    it in plain text; `story` tells it to someone who knows the rig alone. `twins` are effects that data can hardly or not tell apart
    from it, each with the reason. Where `smooth` is false a fit needs the parameters' `starts` as a grid. `same_as` is the nominal
    plant's parameter that does the same where it is not 0, `copy_of` the effect that does the same on this plant, of which this is another
    name: plants may have either, a diagnosis asks for that one. Where `names_a_gap` is false the nominal plant leaves open whether it is
    there: a diagnosis supposes it where the logs ask for it, and calls that no gap. Where `repeats` is false each run has another
    phase of it: plants and simulations carry one, a diagnosis takes none from the plant file, and looks for it as noise or not at all.

    It acts in one of three ways. `edit` changes the equations: edit(model, *symbols). `applied` says what arrives of the inputs at the
    equations, without memory: applied(*symbols) -> {input: expression}. `on_input` and `on_output` give a stage with memory on the way
    of the inputs or of one output from the values by symbol. A filter carries it likewise, or by a `filter_state`.

    `prior` is what one believes of it before any log. Where `holds_at_rest` is true it is dry friction that keeps its axis at rest by
    its level, of which slopes in motion know nothing. Where `needs_gravity` it is gone when the rig is mounted so that gravity turns no
    axis. Where `everywhere` hardly any rig is without it. `term` is the term of angle and speed that it is in a plain regression, `said`
    its kind in words where that is more than the name without underscores.
    """

    name: str
    depends: str
    parameters: tuple[EffectParameter, ...]
    equation: str
    story: str
    source: str
    edit: Callable[..., Model] | None = None
    applied: Callable[..., Mapping[sympy.Symbol, sympy.Expr]] | None = None
    on_input: Callable[..., InputStage] | None = None
    on_output: Callable[..., OutputStage] | None = None
    smooth: bool = True
    twins: Mapping[str, str] = field(default_factory=dict)
    same_as: str = ""
    copy_of: str = ""
    names_a_gap: bool = True
    repeats: bool = True
    filter_state: FilterState | None = None
    prior: Prior = RARE
    holds_at_rest: bool = False
    needs_gravity: bool = False
    everywhere: bool = False
    term: str = ""
    said: str = ""

    @property
    def place(self) -> str:
        """Where it acts."""
        return place_and_kind(self.name)[0]

    @property
    def kind(self) -> str:
        """Its name without the place."""
        return place_and_kind(self.name)[1]

    @property
    def class_text(self) -> str:
        """What the missing term depends on, and where it acts."""
        return f"{self.depends} on {self.place}"

    @property
    def parameter(self) -> Mapping[str, EffectParameter]:
        """Its parameters by symbol."""
        return {parameter.symbol: parameter for parameter in self.parameters}

    @property
    def absent(self) -> Values:
        """Values at which it is not there, its shapes middling."""
        return {parameter.symbol: parameter.first for parameter in self.parameters}

    @property
    def size(self) -> EffectParameter:
        """The first parameter with which it vanishes."""
        return next(parameter for parameter in self.parameters if parameter.is_size)

    def having(self, *roles: Role) -> EffectParameter | None:
        """Its parameter of one of these roles; None where it has none."""
        return next((parameter for parameter in self.parameters if parameter.role in roles), None)

    def symbol(self, *roles: Role) -> str:
        """The symbol of that parameter; an error where it has none."""
        found = self.having(*roles)
        if found is None:
            raise LookupError(f"{self.name} has no {' or '.join(role.name for role in roles)} (sim/effect.py, Role)")
        return found.symbol

    @property
    def is_event(self) -> bool:
        """Whether it happens at an instant."""
        return self.having(Role.INSTANT) is not None

    @property
    def swings(self) -> bool:
        """Whether it is a sine of something."""
        return self.having(Role.PHASE) is not None

    @property
    def is_limit(self) -> bool:
        """Whether it does nothing at all until its size is reached."""
        return self.having(*LIMITS) is not None

    @property
    def shown_in_readings(self) -> bool:
        """Whether its number is read off the log: a sensor's coarse readings lie on its grid, and on no grid a little beside it."""
        return self.on_output is not None and self.having(Role.STEP) is not None

    @property
    def loses_commands(self) -> bool:
        """Whether commands are lost by it."""
        return self.having(Role.LOSS) is not None

    @property
    def is_noise(self) -> bool:
        """Whether a filter carries it as a state that noise drives."""
        return self.filter_state is not None and self.filter_state.noise is not None

    @property
    def reads_late(self) -> bool:
        """Whether a filter carries it as a state that follows an output, and reads that."""
        return self.filter_state is not None and bool(self.filter_state.follows)

    @property
    def on_equations(self) -> bool:
        """Whether the model carries it, with derivatives by its parameters; otherwise it is a stage on the way of a signal."""
        return self.on_input is None and self.on_output is None

    def told(self, values: Values) -> Values:
        """The values as one tells them: of a size that may be mirrored in its angle the positive one, the angle within half a turn.

        (1)  a sin(x + phase) = -a sin(x + phase + pi)
        """
        angle = self.having(Role.PHASE, Role.DIRECTION)
        if angle is None:
            return values
        size, turned = values[self.size.symbol], values[angle.symbol]
        within = math.remainder(turned if size >= 0.0 else turned + math.pi, 2.0 * math.pi)
        return {**values, self.size.symbol: abs(size), angle.symbol: within}

    @property
    def specs(self) -> tuple[ParameterSpec, ...]:
        """Its parameters as a model carries them."""
        return tuple(ParameterSpec(coefficient(self.name, p.symbol), 1, p.unit) for p in self.parameters)

    @property
    def symbols(self) -> tuple[sympy.Symbol, ...]:
        """Its parameters as they stand in the equations."""
        return tuple(symbol for spec in self.specs for symbol in spec.symbols)


def place_and_kind(name: str) -> tuple[str, str]:
    """Where an effect acts, and what it is called there: azimuth.tilt is a tilt of the azimuth."""
    place, _, kind = name.partition(".")
    return place, kind


def coefficient(effect: str, symbol: str) -> str:
    """The name of an effect's parameter among the model's: azimuth_cable_spring_k."""
    return f"{effect.replace('.', '_')}_{symbol}"
