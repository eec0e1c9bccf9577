"""The loops that a law closes, by the names that plant, table, protocol and pages give to their parts: named here, derived elsewhere.

A loop measures and commands in the SI units that its columns' names end in. Inside the program, and in what all loops of a C text share,
`_rad` stands for the unit of a loop's output and `_V` for that of its input; where a name is seen outside, `Loop.own` gives it theirs.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from records.errors import BadInput
from records.text import checks
from records.text.units import unit_of, unit_suffix

MOST_LOOPS = 4
FULL_SCALE_V = 10.0  # of a PWM that nothing else is said of: what the helicopter's drivers give at full duty
ADC_CODES = 4096  # 12 bits, as the converters of all boards have
TABLE_KEYS = ("schema", "digest", "plant", "sample_period_s", "origin", "loops")  # what a table has beside its axes
PARTS = ("axis", "output", "input", "motor")  # of a loop, each by its name
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,30}")
# What C11 and C++ keep for themselves: a loop's names become members and functions of headers that both read.
_C_WORDS = frozenset(
    """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl const const_cast constexpr continue
    decltype default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int
    long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast
    restrict return short signed sizeof static static_assert static_cast struct switch template this thread_local throw true try
    typedef typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq
    """.split()  # noqa: SIM905
)
_OF_THE_LAW = ("axis",)  # whose limits would be called as the type of all limits


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


def parse_loops(entries: Any, where: str) -> tuple[Loop, ...]:
    """One to four loops of distinct names; raises BadInput."""
    if not isinstance(entries, list) or not 1 <= len(entries) <= MOST_LOOPS:
        raise BadInput("loops", where, repr(entries)[:60], f"a list of 1 to {MOST_LOOPS} loops", "name fewer loops")
    loops = tuple(parse_loop(entry, f"{where}[{index}]") for index, entry in enumerate(entries))
    demand_distinct(loops, where)
    return loops


def demand_distinct(loops: Sequence[Loop], where: str) -> None:
    """Raise BadInput where two loops share a name, a column or a pin."""
    named = {name: [getattr(loop, name) for loop in loops] for name in PARTS}
    named["pins"] = [name for loop in loops if loop.pins is not None for name in loop.pins.names]
    for what, names in named.items():
        if len(set(names)) < len(names):
            raise BadInput("loops", where, f"{what} {', '.join(names)}", "each once", "name each loop's own")
    _demand_own_symbols(loops, where)
    _demand_own_members(loops, where)


def _demand_own_symbols(loops: Sequence[Loop], where: str) -> None:
    """Names in C are made of the columns without their units, in macros in capitals: theta of theta_rad, THETA and THETA_REF."""
    known: dict[str, str] = {}
    for loop in loops:
        columns = {loop.output: loop.symbol, loop.reference: f"{loop.symbol}_ref", loop.input: loop.voltage}
        for column, symbol in columns.items():
            other, known[symbol.upper()] = known.get(symbol.upper()), column
            if other is not None:
                expected = "columns that differ in capitals without their units, as names in C are made of these"
                remedy = f"rename one in the equations: u_{column}, say"
                got = f"{column} and {other}, both {symbol.upper()!r} in capitals without their units"
                raise BadInput("loops", where, got, expected, remedy)


def _demand_own_members(loops: Sequence[Loop], where: str) -> None:
    """The law's state holds each loop by its name, beside what was measured and asked for last."""
    columns = [name for loop in loops for name in (loop.output, loop.reference)]
    for loop in loops:
        if loop.axis in columns:
            got = f"a loop called {loop.axis!r}, as a column is"
            raise BadInput("loops", where, got, "a name of its own", f"call it {loop.symbol}, say")


def parse_loop(entry: Any, where: str) -> Loop:
    """One loop, as a table's file states it; raises BadInput naming the part that cannot be used."""
    section = checks.table(entry, where)
    checks.keys(section, where, PARTS, ("pins",))
    named = {name: checks.text(section[name], f"{where}.{name}") for name in PARTS}
    loop = Loop(named["axis"], named["output"], named["input"], named["motor"])
    if "pins" in section:
        loop = replace(loop, pins=_pins(section["pins"], f"{where}.pins", loop))
    for name, value in named.items():
        if not _NAME.fullmatch(value):
            expected = "letters a to z, digits and _, as in C, a letter first, 31 at most"
            raise BadInput("name", f"{where}.{name}", repr(value), expected, "choose another name")
    if loop.axis in (*TABLE_KEYS, *_OF_THE_LAW):
        got = f"{loop.axis!r}, which the table or its C has for something else"
        raise BadInput("name", f"{where}.axis", got, "a name of its own", "choose another name")
    for name in ("axis", "motor"):
        if named[name].isupper():
            got = f"{named[name]!r}, in capitals as the macros of C headers are"
            raise BadInput("name", f"{where}.{name}", got, "a small letter in it", f"write {named[name].lower()}, say")
    for name, value in (("axis", loop.axis), ("motor", loop.motor), ("output", loop.symbol), ("input", loop.voltage)):
        if value in _C_WORDS:
            got = f"{named[name]!r}, in C {value!r}, a word of that language or of C++"
            raise BadInput("name", f"{where}.{name}", got, "a name that no keyword is", "choose another name")
    return loop


def _pins(entry: Any, where: str, loop: Loop) -> Pins:
    section = checks.table(entry, where)
    sensor = "analogue" if "analogue" in section else "encoder"
    scale = loop.own("full_scale_V")
    checks.keys(section, where, (sensor, "pwm", scale), ("direction",))
    names = {name: checks.text(section[name], f"{where}.{name}") for name in ("pwm", "direction") if name in section}
    full_scale_V = checks.positive(section[scale], f"{where}.{scale}")
    if sensor == "analogue":
        analogue = _analogue(section[sensor], f"{where}.{sensor}", loop)
        return Pins(None, names["pwm"], names.get("direction"), analogue, full_scale_V)
    encoder = _encoder(section[sensor], f"{where}.{sensor}")
    return Pins(encoder, names["pwm"], names.get("direction"), None, full_scale_V)


def _encoder(entry: Any, where: str) -> tuple[str, str]:
    if not isinstance(entry, list | tuple) or len(entry) != 2:
        raise BadInput("encoder", where, repr(entry)[:40], "the names of two pins", 'write encoder = ["PA0", "PA1"]')
    first, second = (checks.text(name, where) for name in entry)
    return first, second


def _analogue(entry: Any, where: str, loop: Loop) -> Analogue:
    section = own_section(entry, where, loop, Analogue.__dataclass_fields__)
    scales = ("zero_scale_rad", "full_scale_rad")
    return Analogue(
        checks.text(section["pin"], f"{where}.pin"),
        *(checks.number(section[name], f"{where}.{loop.own(name)}") for name in scales),
    )


def own_section(entry: Any, where: str, loop: Loop, names: Iterable[str]) -> dict[str, Any]:
    """A section whose keys are in the loop's units, by the names inside; raises BadInput unless they are those of `names`."""
    section, names = checks.table(entry, where), tuple(names)
    checks.keys(section, where, map(loop.own, names))
    return {name: section[loop.own(name)] for name in names}
