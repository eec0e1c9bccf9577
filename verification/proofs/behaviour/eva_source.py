"""C texts for Frama-C EVA: the float32 law with its comparisons as comparisons, and the drivers that call it for ever.

The law compares floats by the integers that order them, which an analysis of intervals cannot follow. In the view those
predicates are the float comparisons that they stand for; the proof of totality shows that they agree for every pair of floats.
"""

import re
from collections.abc import Iterator, Mapping, Sequence

from codegen.law_frame import LawInput
from codegen.law_terms import Names
from codegen.numbers import c_float32
from records.loops import Loop
from verification.ranges import Range

# A filter that does not move by its step moves to somewhere between where it is and where it is to go.
_ADVANCED = """#include "__fc_builtin.h"

static law_number advanced(law_number last, law_number step, law_number target)
{
    const law_number moved = last + step;
    const law_number low = (last < target) ? last : target;
    const law_number high = (last < target) ? target : last;
    const law_number anywhere = Frama_C_float_interval(-FLT_MAX, FLT_MAX);
    return (moved != last || anywhere < low || high < anywhere) ? moved : anywhere;
}
"""
# The law's predicates on bits, and what they mean.
_MEANING: Mapping[str, str] = {
    "bits_of": "",
    "magnitude_bits": "",
    "rank_of": "",
    "is_less": "#define is_less(value, other) ((value) < (other))\n",
    "is_finite": "#define is_finite(value) (-FLT_MAX <= (value) && (value) <= FLT_MAX)\n",
    "is_nan": "#define is_nan(value) ((value) != (value))\n",
    "is_plausible": "#define is_plausible(value, bound) (-(bound) <= (value) && (value) <= (bound))\n",
    "settle": "#define settle(value, least) ((-(least) < (value) && (value) < (least)) ? 0.0f : (value))\n",
    "number_of": "",
    "advanced": _ADVANCED,
}

_DRIVER = """#include "law.h"
#include "__fc_builtin.h"

static law_number any_number(void)
{{
    union {{
        uint32_t bits;
        law_number number;
    }} view;
    view.bits = Frama_C_unsigned_int_interval(0u, 0xFFFFFFFFu);
    return view.number;
}}

int main(void)
{{
    law_state state;
    law_input input;
    law_output output;
    law_reset(&state, {angles});
    while (1) {{
{given}
        law_step(&state, &input, &output);
{outputs}
{counts}
    }}
}}
"""

_PREDICATES_DRIVER = """#include "law.c"
#include "__fc_builtin.h"

static law_number any_number(void)
{
    number_view view;
    view.bits = Frama_C_unsigned_int_interval(0u, 0xFFFFFFFFu);
    return view.number;
}

int main(void)
{
    while (1) {
        const law_number one = any_number();
        const law_number other = any_number();
        const bool answers[] = {is_less(one, other), is_finite(one), is_nan(one), is_plausible(one, other)};
@SETTLED@        const law_number arrived = advanced(one, 0.0f, other);
    }
}
"""


def comparison_view(law_c: str) -> str:
    """law.c with its predicates on bits as comparisons of floats; raises ValueError where one of them is not as it was."""
    for name, meaning in _MEANING.items():
        if name == "settle" and not _has_settle(law_c):
            continue
        found = re.compile(rf"static \w+ {name}\([^)]*\)\n\{{\n.*?\n\}}\n", re.DOTALL)
        law_c, count = found.subn(lambda _, meaning=meaning: meaning, law_c)  # type: ignore[misc]
        if count != 1:
            raise ValueError(f"law.c defines {name} {count} times, not once")
    return law_c


def predicates_driver(law_c: str) -> str:
    """Each predicate of law.c on any bits."""
    settled = "        const law_number settled = settle(one, other);\n"
    return _PREDICATES_DRIVER.replace("@SETTLED@", settled if _has_settle(law_c) else "")


def _has_settle(law_c: str) -> bool:
    """A law without a schedule has no angle to settle."""
    return "law_number settle(" in law_c


def driver_in_range(loops: tuple[Loop, ...], given: LawInput[Range]) -> str:
    """Every input of a law of `loops` anywhere within its range, step after step."""
    references, angles = (
        [_interval(limits) for limits in ranges] for ranges in (given.references_rad, given.angles_rad)
    )
    return _driver(loops, references, angles, " + ".join(f"output.{loop.input}" for loop in loops))


def driver_of_any_bits(loops: tuple[Loop, ...]) -> str:
    """Every input any 32 bits, NaN and infinities included, step after step."""
    anything = ["any_number()"] * len(loops)
    return _driver(loops, anything, anything, "any_number()")


def _driver(loops: tuple[Loop, ...], references: Sequence[str], angles: Sequence[str], voltage: str) -> str:
    names = [*(loop.reference for loop in loops), *(loop.output for loop in loops)]
    rows = zip(names, (*references, *angles), strict=True)
    any_count = "Frama_C_interval(INT32_MIN, INT32_MAX)"
    return _DRIVER.format(
        angles=", ".join(angles),
        given="\n".join(f"        input.{name} = {value};" for name, value in rows),
        outputs="\n".join(asserted_outputs(loops, voltage)),
        counts="\n".join(f"        law_angle_from_counts_{loop.symbol}({any_count});" for loop in loops),
    )


def asserted_outputs(loops: tuple[Loop, ...], voltage: str) -> Iterator[str]:
    """Lines of C that assert the limits of each output, and of the duty of `voltage`."""
    for loop in loops:
        names, name = Names(loop), loop.motor
        least, most = (f"LAW_{names.voltage}_{end}{names.voltage_unit}" for end in ("MIN", "MAX"))
        yield f"        /*@ assert {name}_within: {least} <= output.{loop.input} <= {most}; */"
        yield f"        const int32_t {name}_ticks = law_duty_{name}({voltage});"
        yield f"        /*@ assert {name}_duty: -LAW_PWM_TICKS <= {name}_ticks <= LAW_PWM_TICKS; */"


def _interval(limits: Range) -> str:
    return f"Frama_C_float_interval({c_float32(limits[0])}, {c_float32(limits[1])})"
