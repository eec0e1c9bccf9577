"""C texts for Frama-C EVA: the fixed-point law with its branch-free decisions as comparisons, and the drivers that call it for ever.

The law decides by masks, so that a step takes the same time whatever its numbers; an analysis of intervals cannot follow masks. In
the view a decision is the comparison that it stands for, with every difference that it takes; the proof of totality
(smt_fixed.py) shows that both give the same word. Everything else, products above all, is analysed as it was generated.
"""

import re
from collections.abc import Mapping

from codegen.law_terms import Names
from records.loops import Loop
from verification.proofs.behaviour.eva_source import asserted_outputs

# The law's decisions by masks, and what they mean.
_MEANING: Mapping[str, str] = {
    "negative_part": "",
    "clamp": """static int32_t clamp(int32_t value, int32_t low, int32_t high)
{
    const int32_t above_low = value - low;
    const int32_t raised = (value < low) ? low : value;
    const int32_t below_high = high - raised;
    return (high < raised) ? high : raised;
}
""",
    "held": """static int32_t held(int32_t value, int32_t low, int32_t high)
{
    return (value < low) ? low : (high < value) ? high : value;
}
""",
    "accepted": """static law_number accepted(law_number value, law_number last)
{
    return (value == LAW_MISSING) ? last : value;
}
""",
    "is_within": """static uint32_t is_within(int32_t value, uint32_t bits)
{
    return (-(1 << bits) <= value && value < (1 << bits)) ? 0xFFFFFFFFu : 0u;
}
""",
    "masked": """static int32_t masked(int32_t value, uint32_t mask)
{
    return (mask != 0u) ? value : 0;
}
""",
}
# A filter's step ends between where it began and where it was to go.
_TOWARDS = """static int32_t towards(int32_t value, int32_t target, int32_t gain)
{
    const int32_t step = 2 * (target - value);
    const int32_t anywhere = Frama_C_interval(INT32_MIN, INT32_MAX);
    return (value < target) ? held(anywhere, value, target) : held(anywhere, target, value);
}
"""
# Two lines of drive(): the move is a word of 31 bits, and v takes it only where both conditions hold.
_MOVE = re.compile(r"    const law_number move_V = \(int32_t\)\(whole & fits\);.*\n")
_MOVE_MEANS = "    const law_number move_V = Frama_C_interval(-0x40000000, 0x3FFFFFFF);\n"
_TAKEN = re.compile(
    r"    const uint32_t plausible = fits & is_within\(last_V \+ move_V, (\d+)u\);\n"
    r"    const law_number v_V = last_V \+ masked\(move_V, plausible\);\n"
)
_TAKEN_MEANS = r"""    const law_number moved_V = last_V + move_V;
    const uint32_t plausible = fits & is_within(moved_V, \1u);
    const law_number v_V = (fits != 0u && -(1 << \1u) <= moved_V && moved_V < (1 << \1u)) ? moved_V : last_V;
"""

_ANY_WORD = """static law_number any_word(void)
{
    return Frama_C_interval(INT32_MIN, INT32_MAX);
}
"""

_DRIVER = f"""#include "law.h"
#include "__fc_builtin.h"

{_ANY_WORD}
int main(void)
{{
    union {{
        law_state state;
        int32_t words[sizeof(law_state) / sizeof(int32_t)];
    }} memory;
    law_input input;
    law_output output;
    law_reset(&memory.state, @ANGLES@);
    while (1) {{
        for (uint32_t i = 0u; i < sizeof(law_state) / sizeof(int32_t); i++) {{
            memory.words[i] = any_word();
        }}
@GIVEN@
        law_step(&memory.state, &input, &output);
@OUTPUTS@
    }}
}}
"""


def driver(loops: tuple[Loop, ...]) -> str:
    """State and inputs of a law of `loops` any words, step after step."""
    names = [*(loop.reference for loop in loops), *(loop.output for loop in loops)]
    counts = (
        f"        const law_number {loop.output} = law_angle_from_counts_{loop.symbol}(any_word());" for loop in loops
    )
    parts = {
        "@ANGLES@": ", ".join(["any_word()"] * len(loops)),
        "@GIVEN@": "\n".join(f"        input.{name} = any_word();" for name in names),
        "@OUTPUTS@": "\n".join((*asserted_outputs(loops, "any_word()"), *counts)),
    }
    text = _DRIVER
    for place, lines in parts.items():
        text = text.replace(place, lines)
    return text


# Every decision as it was generated; clamp and drive() are left to the proof of totality, which knows what their words can be.
_DECISIONS_DRIVER = f"""#include "law.c"
#include "__fc_builtin.h"

{_ANY_WORD}
int main(void)
{{
    while (1) {{
        const int32_t one = any_word();
        const int32_t other = any_word();
        const uint32_t places = Frama_C_unsigned_int_interval(0u, 30u);
        const int32_t words[] = {{
            floored(one, places), low_half(one), negative_part(one), accepted(one, other), wrapped(one, places),
            masked(one, (uint32_t)other), held(one, @LEAST@, @MOST@), held_angle(one, other),
        }};
        const uint32_t within = is_within(one, places);
        const int32_t high = high_word(product(one, other));
    }}
}}
"""


def decisions_driver(loops: tuple[Loop, ...]) -> str:
    """Each decision on any words; references are held within the first loop's range."""
    names, text = Names(loops[0]), _DECISIONS_DRIVER
    for place, end in (("@LEAST@", "MIN"), ("@MOST@", "MAX")):
        text = text.replace(place, f"LAW_{names.angle}_REF_{end}{names.angle_unit}")
    return text


def decision_view(law_c: str) -> str:
    """law.c with its masks as comparisons; raises ValueError where one of them is not as it was."""
    has_filter = "static int32_t towards(" in law_c  # a law whose references are taken as they are has none
    for name, meaning in (*_MEANING.items(), *([("towards", _TOWARDS)] if has_filter else [])):
        found = re.compile(rf"static \w+ {name}\([^)]*\)\n\{{\n.*?\n\}}\n", re.DOTALL)
        law_c = _replaced(law_c, name, found, meaning)
    law_c = _replaced(law_c, "move_V", _MOVE, _MOVE_MEANS)
    law_c = _replaced(law_c, "v_V", _TAKEN, _TAKEN_MEANS)
    return law_c.replace('#include "law.h"\n', '#include "law.h"\n#include "__fc_builtin.h"\n', 1)


def _replaced(law_c: str, name: str, found: re.Pattern[str], meaning: str) -> str:
    """`meaning` is a template of re.sub."""
    text, count = found.subn(meaning, law_c)
    if count != 1:
        raise ValueError(f"law.c defines {name} {count} times, not once")
    return text
