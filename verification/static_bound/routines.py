"""What is known of the compiler's run-time routines: which take floats, and how often their loops may run."""

from collections.abc import Mapping
from dataclasses import dataclass

from verification.static_bound import words
from verification.static_bound.words import TOP, Word


@dataclass(frozen=True)
class LoopBound:
    """The loop whose head comes `ordinal`-th in `function` passes its head at most `passes` times each time it is entered."""

    function: str
    ordinal: int
    passes: int
    reason: str


# Loops whose count the analysis cannot find by itself; keyed by the symbol and the order of the heads' addresses.
KNOWN_LOOPS = (
    LoopBound("__aeabi_uidiv", 0, 17, "long division, two of at most 32 quotient bits in a pass"),
    LoopBound("__udivsi3", 0, 17, "long division, two of at most 32 quotient bits in a pass"),
)

# Number of leading arguments that are float32: these routines are analysed for each class of float by itself, because their paths for
# subnormals, infinities and NaN exclude one another. The classes cover all 2^32 words, so a wrong entry costs time, not truth.
FLOAT_ARGUMENTS: Mapping[str, int] = {
    "__aeabi_fadd": 2, "__aeabi_fsub": 2, "__aeabi_fmul": 2, "__aeabi_fdiv": 2,
    "__aeabi_fcmpeq": 2, "__aeabi_fcmplt": 2, "__aeabi_fcmple": 2, "__aeabi_fcmpge": 2, "__aeabi_fcmpgt": 2, "__aeabi_fcmpun": 2,
    "__aeabi_f2iz": 1, "__aeabi_f2uiz": 1,
}  # fmt: skip

_MAGNITUDES = ((0, 0), (1, 0x7FFFFF), (0x800000, 0x7F7FFFFF), (0x7F800000, 0x7F800000), (0x7F800001, 0x7FFFFFFF))
FLOAT_CLASSES = tuple(words.interval(sign | low, sign | high) for sign in (0, 0x80000000) for low, high in _MAGNITUDES)


def cases(function: str, arguments: Mapping[int, Word]) -> list[dict[int, Word]]:
    """Split unknown float arguments of a run-time routine by class; together the cases hold all values of `arguments`."""
    found: list[dict[int, Word]] = [dict(arguments)]
    for register in range(FLOAT_ARGUMENTS.get(function, 0)):
        if arguments.get(register) == TOP:
            found = [{**case, register: word} for case in found for word in FLOAT_CLASSES]
    return found
