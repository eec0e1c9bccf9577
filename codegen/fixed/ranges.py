"""Proof that the fixed-point law cannot overflow: its equations run on whole ranges of integers, for every state and input.

Each word of state and input is any 32-bit word. Every stored result must lie within 32 bits and every sum of products within 64;
what the law keeps by its checks and limits is all that is used. The ranges found stand in the comments of the generated C.
"""

from dataclasses import dataclass
from typing import Any

from codegen.fixed.constants import FixedLaw, fixed_constants, word_number
from codegen.fixed.equations import fixed_axis_state, law_reset, law_step, state_from_words
from codegen.law_frame import LawInput, state_size
from records.errors import BadInput
from records.table import ControllerTable

Range = tuple[int, int]
ANY_WORD = (-(2**31), 2**31 - 1)
_WIDE = 2**63


@dataclass(frozen=True)
class Interval:
    """All integers low..high."""

    low: int
    high: int

    def __add__(self, other: "Interval | int") -> "Interval":
        low, high = _ends(other)
        return _wide(self.low + low, self.high + high)

    def __sub__(self, other: "Interval") -> "Interval":
        return _wide(self.low - other.high, self.high - other.low)

    def __mul__(self, other: "Interval | int") -> "Interval":
        ends = [one * two for one in (self.low, self.high) for two in _ends(other)]
        if other is self:
            ends = [max(ends), 0 if self.low <= 0 <= self.high else min(self.low**2, self.high**2)]
        return _wide(min(ends), max(ends))


@dataclass(frozen=True)
class Within:
    """The condition that `value` lies within limits, and what it leaves of it."""

    value: Interval
    held: Interval


class Intervals:
    """The law's decisions on intervals; `ranges` holds, name by name, the hull of all that was stored under it."""

    def __init__(self) -> None:
        self.ranges: dict[str, Range] = {}

    def word(self, name: str, value: Interval) -> Interval:
        low, high = self.ranges.get(name, (value.low, value.high))
        self.ranges[name] = (min(low, value.low), max(high, value.high))
        if not ANY_WORD[0] <= value.low <= value.high <= ANY_WORD[1]:
            raise _too_wide(name, value)
        return value

    def floored(self, value: Interval, places: int) -> Interval:
        return Interval(value.low >> places, value.high >> places)

    def clamp(self, value: Interval, low: Interval, high: Interval) -> Interval:
        self.word("less the lower limit", value - low)
        self.word("to the upper limit", high - value)
        return Interval(max(low.low, min(value.low, high.low)), min(high.high, max(value.high, low.high)))

    def accepted(self, value: Interval, last: Interval) -> Interval:
        return _hull(value, last)

    def held(self, value: Interval, low: Interval, high: Interval) -> Interval:
        if not low.high <= 0 <= high.low:
            raise _too_wide("limits on one side of zero", Interval(low.low, high.high))
        return Interval(max(low.low, min(value.low, high.high)), min(high.high, max(value.high, low.low)))

    def towards(self, value: Interval, target: Interval, gain: Interval) -> Interval:
        """Between value and target, as 0 <= gain < 1 and a step of d is rounded to |d| at most."""
        self.word("twice the step of a filter", (target - value) * 2)
        return _hull(value, target)

    def whole(self, total: Interval, places: int) -> tuple[None, Interval]:
        self.word("high word of a sum", self.floored(total, 32))
        low, high = (max(-(2**30), min(2**30 - 1, end >> places)) for end in (total.low, total.high))
        return None, self.word("move_V", Interval(min(low, 0), max(high, 0)))

    def both(self, one: None, other: Within) -> Within:
        return other

    def fraction(self, value: Interval, places: int) -> Interval:
        return Interval(0, 2**places - 1)

    def is_within(self, value: Interval, bits: int) -> Within:
        return Within(value, Interval(max(value.low, -(2**bits)), min(value.high, 2**bits - 1)))

    def choose(self, condition: Within, value: Interval, otherwise: Interval) -> Interval:
        return _hull(condition.held if value is condition.value else value, otherwise)

    def wrapped(self, value: Interval, bits: int) -> Interval:
        if -(2**bits) <= value.low and value.high < 2**bits:
            return value
        return Interval(-(2**bits), 2**bits - 1)

    def scaled(self, value: Interval, x: Interval) -> Interval:
        exact = self.floored(value * x, 32)
        return Interval(exact.low - 2, exact.high)

    def narrow_product(self, value: Interval, x: Interval) -> Interval:
        low_half = Interval(0, 2**16 - 1)
        one, other = self.floored(value, 16) * low_half, self.floored(x, 16) * low_half
        self.word("middle of a narrow product", one + other + low_half)
        return value * x

    def scaled_short(self, value: Interval, x: Interval) -> Interval:
        self._demand_short(value)
        return self.word("a short product", self.floored(value * x, 16))

    def short_product(self, value: Interval, x: Interval) -> Interval:
        self._demand_short(value)
        return value * x

    def _demand_short(self, value: Interval) -> None:
        """Half products of a number of 16 bits fit one word; raises BadInput where it has more."""
        if not -(2**15) < value.low <= value.high < 2**15:
            raise _too_wide("a short coefficient", value)


@dataclass(frozen=True)
class OverflowProof:
    """Least and largest word of every stored result, for any state and input whatever."""

    ranges: dict[str, Range]


def prove_no_overflow(table: ControllerTable) -> OverflowProof:
    """Run the law on any words; raises BadInput, naming the result, when one could leave its 32 or 64 bits."""
    law: FixedLaw[Any] = fixed_constants(table, _exactly)
    words = Intervals()
    loops = len(table.loops)
    remembered_words = _any(state_size(fixed_axis_state(table.order), loops))
    state, voltages = law_step(law, words, state_from_words(law, remembered_words), LawInput.of(_any(2 * loops)))
    law_reset(law, words, _any(loops))
    for remembered, axis in zip(state.axes, law.axes, strict=True):
        name = axis.name
        words.word(f"{name}.v_residue", remembered.v_residue)
        for field, bits in (("e_0_rad", law.error_bits), ("s_0_V", law.s_bits), ("w_0_V", law.w_bits)):
            _demand_kept(f"{name}.{field}", getattr(remembered, field), bits)
        _demand_half(name, axis)
    for loop, voltage in zip(table.loops, voltages, strict=True):
        words.word(loop.input, voltage)
    return OverflowProof(words.ranges)


def _demand_kept(name: str, value: Interval, bits: int) -> None:
    """A state that the law leaves must pass the law's own check in the next sample."""
    if not -(2**bits) <= value.low <= value.high < 2**bits:
        raise _too_wide(name, value)


def _demand_half(name: str, axis: Any) -> None:
    if not 3 <= axis.residue_places <= 30:
        raise BadInput("formats", name, f"{axis.residue_places} places below a voltage", "3 to 30", "use float32")


def _any(count: int) -> list[Interval]:
    return [Interval(*ANY_WORD) for _ in range(count)]


def _exactly(value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> Interval:
    word = word_number(value, places, made_up, neglected)
    return Interval(word, word)


def _ends(number: Interval | int) -> Range:
    return (number, number) if isinstance(number, int) else (number.low, number.high)


def _hull(one: Interval, other: Interval) -> Interval:
    return Interval(min(one.low, other.low), max(one.high, other.high))


def _wide(low: int, high: int) -> Interval:
    if not -_WIDE <= low <= high < _WIDE:
        raise _too_wide("a sum of products", Interval(low, high))
    return Interval(low, high)


def _too_wide(name: str, value: Interval) -> BadInput:
    return BadInput(
        "fixed-point formats",
        name,
        f"words {value.low}..{value.high}",
        "results within 32 bits, sums of products within 64",
        "choose slower poles and design the table again, or use --arithmetic float32",
    )
