"""What an effect is: physics that a rig may have and its model lacks."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy

from sim.model import Model, ParameterSpec
from sim.paths.path import InputStage, OutputStage

Values = Mapping[str, float]
TOUCH = 1e-9


@dataclass(frozen=True)
class EffectParameter:
    """A number of an effect's formula, under the formula's symbol.

    `zero` is the value at which the effect vanishes, None for a number that only shapes it; `reference` is a size that one may meet
    on such a rig. `starts` are the values from which a fit begins where one is not enough; all lie within [lower, upper]. One that is
    `refining` is 0 in the effect's plain formula, and a plant file may leave it out.
    """

    symbol: str
    unit: str
    lower: float
    upper: float
    reference: float
    zero: float | None = None
    starts: tuple[float, ...] = ()
    refining: bool = False

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


@dataclass(frozen=True, eq=False)
class Effect:
    """One effect at one place of one plant.

    `depends` and `place` make the class ("torque(phi) on azimuth"): what the missing term depends on and where it acts. `equation` is
    it in plain text; `story` tells it to someone who knows the rig alone. `twins` are effects that data can hardly or not tell apart
    from it, each with the reason. Where `smooth` is false a fit needs the parameters' `starts` as a grid. `same_as` is the nominal
    plant's parameter that does the same where it is not 0. Where `names_a_gap` is false the nominal plant leaves open whether it is
    there: a diagnosis supposes it where the logs ask for it, and calls that no gap. Where `repeats` is false each run has another
    phase of it: plants and simulations carry one, a diagnosis takes none from the plant file, and looks for it as noise or not at all.

    It acts in one of three ways. `edit` changes the equations: edit(model, *symbols). `applied` says what arrives of the inputs at the
    equations, without memory: applied(*symbols) -> {input: expression}. `on_input` and `on_output` give a stage with memory on the way
    of the inputs or of one output from the values by symbol.
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
    names_a_gap: bool = True
    repeats: bool = True

    @property
    def place(self) -> str:
        """Where it acts."""
        return self.name.split(".")[0]

    @property
    def kind(self) -> str:
        """Its name without the place."""
        return self.name.split(".")[1]

    @property
    def class_text(self) -> str:
        """What the missing term depends on, and where it acts."""
        return f"{self.depends} on {self.place}"

    @property
    def parameter(self) -> Mapping[str, EffectParameter]:
        """Its parameters by symbol."""
        return {parameter.symbol: parameter for parameter in self.parameters}

    @property
    def size(self) -> EffectParameter:
        """The first parameter with which it vanishes."""
        return next(parameter for parameter in self.parameters if parameter.is_size)

    @property
    def on_equations(self) -> bool:
        """Whether the model carries it, with derivatives by its parameters; otherwise it is a stage on the way of a signal."""
        return self.on_input is None and self.on_output is None

    @property
    def specs(self) -> tuple[ParameterSpec, ...]:
        """Its parameters as a model carries them."""
        return tuple(ParameterSpec(coefficient(self.name, p.symbol), 1, p.unit) for p in self.parameters)

    @property
    def symbols(self) -> tuple[sympy.Symbol, ...]:
        """Its parameters as they stand in the equations."""
        return tuple(symbol for spec in self.specs for symbol in spec.symbols)


def coefficient(effect: str, symbol: str) -> str:
    """The name of an effect's parameter among the model's: azimuth_cable_spring_k."""
    return f"{effect.replace('.', '_')}_{symbol}"
