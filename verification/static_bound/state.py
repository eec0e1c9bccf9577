"""What is known of the processor before an instruction: words by location, and where the flags come from."""

from typing import NamedTuple

from verification.static_bound import words
from verification.static_bound.words import MASK, SIGN, TOP, Word

NOWHERE = -1


class Flags(NamedTuple):
    """Flags of the last instruction that set them.

    After a subtraction `a - b` (kind "subtract") all conditions are decided by `a` and `b`; otherwise Z and N by `result`, C by `carry`.
    After a shift by a constant (kind "lsls", "lsrs") Z also tells of `a`, which was shifted by `b`.
    The `_at` members name registers that still hold the operands and the result.
    """

    kind: str = ""
    a: Word = TOP
    b: Word = TOP
    result: Word = TOP
    a_at: int = NOWHERE
    b_at: int = NOWHERE
    result_at: int = NOWHERE
    carry: int | None = None


UNKNOWN_FLAGS = Flags()


class State(NamedTuple):
    """Words known by location (TOP where absent) and flags. A state is never changed once it is made."""

    values: dict[int, Word]
    flags: Flags

    def at(self, location: int) -> Word:
        """What is known of a location."""
        return self.values.get(location, TOP)

    def with_value(self, location: int, word: Word) -> "State":
        """The state after `location` was overwritten."""
        values = {**self.values, location: word}
        if word == TOP:
            del values[location]
        return State(values, _forget(self.flags, location))

    def without(self, locations: frozenset[int]) -> "State":
        """The state after `locations` were overwritten with something unknown."""
        flags = self.flags
        for location in locations:
            flags = _forget(flags, location)
        return State({place: word for place, word in self.values.items() if place not in locations}, flags)


def _forget(flags: Flags, register: int) -> Flags:
    if register == flags.a_at:
        flags = flags._replace(a_at=NOWHERE)
    if register == flags.b_at:
        flags = flags._replace(b_at=NOWHERE)
    return flags._replace(result_at=NOWHERE) if register == flags.result_at else flags


def join_states(a: State, b: State) -> State:
    """A state that holds whatever either holds."""
    shared = a.values.keys() & b.values.keys()
    values = {place: words.join(a.values[place], b.values[place]) for place in shared}
    flags = a.flags if a.flags == b.flags else _joined_flags(a.flags, b.flags)
    return State({place: word for place, word in values.items() if word != TOP}, flags)


def _joined_flags(a: Flags, b: Flags) -> Flags:
    same_places = (a.a_at, a.b_at, a.result_at) == (b.a_at, b.b_at, b.result_at)
    if a.kind != b.kind or not same_places:
        return UNKNOWN_FLAGS
    return Flags(
        a.kind, words.join(a.a, b.a), words.join(a.b, b.b), words.join(a.result, b.result),
        a.a_at, a.b_at, a.result_at, a.carry if a.carry == b.carry else None,
    )  # fmt: skip


OPPOSITE = {"eq": "ne", "hs": "lo", "mi": "pl", "vs": "vc", "hi": "ls", "ge": "lt", "gt": "le"}
OPPOSITE |= {second: first for first, second in OPPOSITE.items()}


def assume(state: State, condition: str) -> State | None:
    """The state where `condition` holds, None where it cannot."""
    flags = state.flags
    result = _result_where(flags.result, condition)
    if result is None:
        return None
    if flags.kind != "subtract":
        carries = {"hs": 1, "hi": 1, "lo": 0}
        possible = flags.carry is None or carries.get(condition, flags.carry) == flags.carry
        source = _shifted_where(flags, condition)
        return _refined(state, flags._replace(a=source, result=result)) if possible and source else None
    pair = _operands_where(flags.a, flags.b, condition)
    if pair is None:
        return None
    narrower = words.common(result, words.subtract(*pair))
    return narrower and _refined(state, flags._replace(a=pair[0], b=pair[1], result=narrower))


def _shifted_where(flags: Flags, condition: str) -> Word | None:
    """What was shifted, where the shift's result is zero or not."""
    amount = flags.b.constant or 0
    match flags.kind, condition:
        case "lsrs", "eq":
            return words.within(flags.a, 0, (1 << amount) - 1)
        case "lsrs", "ne":
            return words.within(flags.a, 1 << amount, MASK)
        case "lsls", "eq":
            return words.common(flags.a, words.bit_pattern(MASK >> amount, 0))
        case "lsls", "ne":
            return words.within(flags.a, 1, MASK)
    return flags.a


def _refined(state: State, flags: Flags) -> State:
    known = dict(state.values)
    for place, word in ((flags.a_at, flags.a), (flags.b_at, flags.b), (flags.result_at, flags.result)):
        if place != NOWHERE and word != TOP:
            known[place] = word
    return State(known, flags)


def _result_where(result: Word, condition: str) -> Word | None:
    match condition:
        case "eq":
            return words.common(result, words.constant(0))
        case "ne":
            return words.within(result, 1, MASK)
        case "mi":
            return words.within(result, SIGN, MASK)
        case "pl":
            return words.within(result, 0, SIGN - 1)
    return result


def _operands_where(a: Word, b: Word, condition: str) -> tuple[Word, Word] | None:
    match condition:
        case "eq":
            both = words.common(a, b)
            return (both, both) if both else None
        case "ne":
            return _unequal(a, b)
        case "lo" | "ls":
            return _ordered(a, b, (a.lowest, a.highest), (b.lowest, b.highest), (0, MASK), condition == "lo")
        case "hi" | "hs":
            return _swapped(_ordered(b, a, (b.lowest, b.highest), (a.lowest, a.highest), (0, MASK), condition == "hi"))
        case "lt" | "le":
            return _ordered(a, b, a.signed_range, b.signed_range, (-SIGN, SIGN - 1), condition == "lt")
        case "gt" | "ge":
            return _swapped(_ordered(b, a, b.signed_range, a.signed_range, (-SIGN, SIGN - 1), condition == "gt"))
    return a, b


Range = tuple[int, int]


def _ordered(
    a: Word, b: Word, a_range: Range, b_range: Range, limits: Range, strictly: bool
) -> tuple[Word, Word] | None:
    """Both operands where a < b (or a <= b), read in the number range `limits`."""
    less = words.within(a, limits[0], b_range[1] - strictly)
    more = words.within(b, a_range[0] + strictly, limits[1])
    return (less, more) if less and more else None


def _swapped(pair: tuple[Word, Word] | None) -> tuple[Word, Word] | None:
    return pair and (pair[1], pair[0])


def _unequal(a: Word, b: Word) -> tuple[Word, Word] | None:
    rest_a = words.within(a, b.start + 1, b.start + MASK) if b.span == 0 else a
    rest_b = words.within(b, a.start + 1, a.start + MASK) if a.span == 0 else b
    return (rest_a, rest_b) if rest_a and rest_b else None
