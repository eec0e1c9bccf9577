"""The loops that a law closes, by the names that plant, table, protocol and pages give to their parts: named here, derived elsewhere.

A loop measures and commands in the SI units that its columns' names end in. Inside the program, and in what all loops of a C text share,
`_rad` stands for the unit of a loop's output and `_V` for that of its input; where a name is seen outside, `Loop.own` gives it theirs.
"""

from dataclasses import dataclass

from records.text.units import unit_of, unit_suffix

MOST_LOOPS = 4
FULL_SCALE_V = 10.0  # of a PWM that nothing else is said of: what the helicopter's drivers give at full duty
ADC_CODES = 4096  # 12 bits, as the converters of all boards have


@dataclass(frozen=True)
class Analogue:
    """A sensor on the converter's input `pin`: what it measures where the converter reads 0 V, and where it reads its reference.

    From there on it is a sensor of counts, as an encoder is: count = +-code + `origin_counts`, and its zero is on a whole count.
    """

    pin: str
    zero_scale_rad: float
    full_scale_rad: float

    @property
    def step_rad(self) -> float:
        """What one code is."""
        return abs(self.full_scale_rad - self.zero_scale_rad) / ADC_CODES

    @property
    def sign(self) -> int:
        """-1 where what is measured falls as the voltage rises."""
        return 1 if self.full_scale_rad > self.zero_scale_rad else -1

    @property
    def origin_counts(self) -> int:
        """The count at code 0."""
        return round(self.zero_scale_rad / self.step_rad)

    @property
    def rails_counts(self) -> tuple[int, int]:
        """The least and the largest count, those of the first and the last code: what a torn wire reads."""
        ends = (self.counts(0), self.counts(ADC_CODES - 1))
        return min(ends), max(ends)

    def counts(self, code: int) -> int:
        """The count at a code."""
        return self.sign * code + self.origin_counts

    def code(self, counts: int) -> int:
        """The code at a count, the nearest of those that there are."""
        return min(max(self.sign * (counts - self.origin_counts), 0), ADC_CODES - 1)


@dataclass(frozen=True)
class Pins:
    """Where a loop hangs on a board: inputs of its `encoder` or its `analogue` sensor, the driver's `pwm` and `direction`.

    The direction is high for negative inputs; None is a driver that turns one way only. Full duty gives `full_scale_V`.
    """

    encoder: tuple[str, str] | None
    pwm: str
    direction: str | None = None
    analogue: Analogue | None = None
    full_scale_V: float = FULL_SCALE_V

    @property
    def names(self) -> tuple[str, ...]:
        """All of them."""
        sensor = (self.encoder or ()) if self.analogue is None else (self.analogue.pin,)
        return (*sensor, self.pwm, *([] if self.direction is None else [self.direction]))


@dataclass(frozen=True)
class Loop:
    """One loop: its `axis`, the columns of what is measured, `output`, and of the commanded `input`, the `motor` driven.

    Columns bear their units: output psi_rad, reference psi_ref_rad, input u_M_V.
    A loop without `pins` flies with the host in the loop.
    """

    axis: str
    output: str
    input: str
    motor: str
    pins: Pins | None = None

    @property
    def output_unit(self) -> str:
        """The unit in the output's name: rad, m, rad_s."""
        return unit_suffix(self.output)

    @property
    def input_unit(self) -> str:
        """The unit in the input's name."""
        return unit_suffix(self.input)

    def own(self, name: str) -> str:
        """A name that ends in _rad, _V or both in this loop's units: reference_min_rad is reference_min_m, q_V_rad q_A_m."""
        output, input = (f"_{unit}" if unit else "" for unit in (self.output_unit, self.input_unit))
        for ending, unit in (("_V_rad", input + output), ("_rad_V", output + input), ("_rad", output), ("_V", input)):
            if name.endswith(ending):
                return name.removesuffix(ending) + unit
        return name

    @property
    def symbol(self) -> str:
        """The output without its unit."""
        return self.output.removesuffix(f"_{self.output_unit}")

    @property
    def voltage(self) -> str:
        """The input without its unit."""
        return self.input.removesuffix(f"_{self.input_unit}")

    @property
    def reference(self) -> str:
        """What the output is to be."""
        return self.own(f"{self.symbol}_ref_rad")

    @property
    def counts(self) -> str:
        """What the output's encoder counts."""
        return f"{self.symbol}_counts"

    @property
    def full_scale_V(self) -> float:
        """What full duty gives."""
        return FULL_SCALE_V if self.pins is None else self.pins.full_scale_V

    @property
    def analogue(self) -> Analogue | None:
        """The analogue sensor on the board, where the loop has one."""
        return None if self.pins is None else self.pins.analogue

    @property
    def duty(self) -> str:
        """What the command is on the board's PWM."""
        return f"duty_{self.motor}_ticks"


# The helicopter's, in the order of the plant's outputs and inputs.
LOOPS = (
    Loop("elevation", "psi_rad", "u_M_V", "main", Pins(("PA0", "PA1"), "PA8", "PB0")),
    Loop("azimuth", "phi_rad", "u_T_V", "tail", Pins(("PA6", "PA7"), "PA9", "PB1")),
)


def full_scales_V(loops: tuple[Loop, ...]) -> tuple[float, ...]:
    """Those of `loops`, each once."""
    return tuple(dict.fromkeys(loop.full_scale_V for loop in loops))


def full_scale_words(loops: tuple[Loop, ...]) -> tuple[str, ...]:
    """Those of `loops` with their units, each once."""
    return tuple(dict.fromkeys(f"{loop.full_scale_V} {unit_of(loop.input)}" for loop in loops))


def has_pins(loops: tuple[Loop, ...]) -> bool:
    """Whether a board has a sensor and an output for each of `loops`; others fly with the host in the loop alone."""
    return all(loop.pins is not None for loop in loops)
