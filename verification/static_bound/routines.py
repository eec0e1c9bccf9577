"""What is known of the compiler's run-time routines: how to split the values of their arguments, so that paths show themselves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from verification.static_bound import words
from verification.static_bound.words import Word


@dataclass(frozen=True)
class LoopBound:
    """Stated by hand: the loop whose head comes `ordinal`-th in `function` passes it at most `passes` times whenever it is entered."""

    function: str
    ordinal: int
    passes: int
    reason: str


_MAGNITUDES = ((0, 0), (1, 0x7FFFFF), (0x800000, 0x7F7FFFFF), (0x7F800000, 0x7F800000), (0x7F800001, 0x7FFFFFFF))

# Zero, subnormal, normal, infinite, NaN, each with both signs: their paths through soft-float routines exclude one another.
FLOAT_CLASSES = tuple(words.interval(sign | low, sign | high) for sign in (0, 1 << 31) for low, high in _MAGNITUDES)

# By the number of leading zeros, on which the passes of a long division depend.
BIT_LENGTHS = (words.constant(0), *(words.interval(1 << k, (2 << k) - 1) for k in range(32)))

# Their result is a float in r0.
FLOAT_RESULTS = frozenset({"__aeabi_fadd", "__aeabi_fsub", "__aeabi_fmul", "__aeabi_fdiv"})

# Each set of classes covers all 2^32 words, so that a wrong entry here costs time or sharpness, never truth.
_FLOATS, _NUMBERS = (FLOAT_CLASSES, FLOAT_CLASSES), (BIT_LENGTHS, BIT_LENGTHS)
ARGUMENT_CLASSES: Mapping[str, Sequence[tuple[Word, ...]]] = {
    **dict.fromkeys(("__aeabi_fadd", "__aeabi_fsub", "__aeabi_fmul", "__aeabi_fdiv"), _FLOATS),
    **{f"__aeabi_fcmp{relation}": _FLOATS for relation in ("eq", "lt", "le", "ge", "gt", "un")},
    **dict.fromkeys(("__aeabi_f2iz", "__aeabi_f2uiz"), (FLOAT_CLASSES,)),
    **dict.fromkeys(("__aeabi_uidiv", "__aeabi_uidivmod"), _NUMBERS),
}


def cases(function: str, arguments: Mapping[int, Word]) -> list[dict[int, Word]]:
    """Split arguments of a run-time routine by class; together the cases hold all values of `arguments`."""
    found: list[dict[int, Word]] = [dict(arguments)]
    for register, classes in enumerate(ARGUMENT_CLASSES.get(function, ())):
        if register in arguments:
            parts = [words.common(word, arguments[register]) for word in classes]
            found = [{**case, register: part} for case in found for part in parts if part]
    return found


# Zero and the other finite numbers, with each sign.
_FINITE_PARTS = tuple((sign | low, sign | high) for sign in (0, 1 << 31) for low, high in ((0, 0), (1, 0x7F7FFFFF)))


def finite_parts(word: Word) -> tuple[Word | None, ...]:
    """What of `word` is zero and what is another finite float, with each sign; all None where something of it is no finite float."""
    outside = (words.within(word, sign | 0x7F800000, sign | 0x7FFFFFFF) for sign in (0, 1 << 31))
    if any(outside):
        return (None,) * len(_FINITE_PARTS)
    return tuple(words.within(word, low, high) for low, high in _FINITE_PARTS)
