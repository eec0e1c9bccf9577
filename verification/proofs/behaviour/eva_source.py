"""C texts for Frama-C EVA: the float32 law with its comparisons as comparisons, and the drivers that call it for ever.

The law compares floats by the integers that order them, which an analysis of intervals cannot follow. In the view those
predicates are the float comparisons that they stand for; the proof of totality shows that they agree for every pair of floats.
"""

import re
from collections.abc import Mapping

from codegen.law_equations import LawInput
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
    law_reset(&state, {psi_rad}, {phi_rad});
    while (1) {{
        input.psi_ref_rad = {psi_ref_rad};
        input.phi_ref_rad = {phi_ref_rad};
        input.psi_rad = {psi_rad};
        input.phi_rad = {phi_rad};
        law_step(&state, &input, &output);
        /*@ assert main_within: LAW_U_M_MIN_V <= output.u_M_V <= LAW_U_M_MAX_V; */
        /*@ assert tail_within: LAW_U_T_MIN_V <= output.u_T_V <= LAW_U_T_MAX_V; */
        const int32_t main_ticks = law_duty_main({voltage});
        const int32_t tail_ticks = law_duty_tail({voltage});
        /*@ assert main_duty: -LAW_PWM_TICKS <= main_ticks <= LAW_PWM_TICKS; */
        /*@ assert tail_duty: -LAW_PWM_TICKS <= tail_ticks <= LAW_PWM_TICKS; */
        law_angle_from_counts_psi(Frama_C_interval(INT32_MIN, INT32_MAX));
        law_angle_from_counts_phi(Frama_C_interval(INT32_MIN, INT32_MAX));
    }}
}}
"""

PREDICATES_DRIVER = """#include "law.c"
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
        const law_number settled = settle(one, other);
        const law_number arrived = advanced(one, 0.0f, other);
    }
}
"""


def comparison_view(law_c: str) -> str:
    """law.c with its predicates on bits as comparisons of floats; raises ValueError where one of them is not as it was."""
    for name, meaning in _MEANING.items():
        found = re.compile(rf"static \w+ {name}\([^)]*\)\n\{{\n.*?\n\}}\n", re.DOTALL)
        law_c, count = found.subn(lambda _, meaning=meaning: meaning, law_c)  # type: ignore[misc]
        if count != 1:
            raise ValueError(f"law.c defines {name} {count} times, not once")
    return law_c


def driver_in_range(given: LawInput[Range]) -> str:
    """Every input anywhere within its range, step after step."""
    ranges = {name: _interval(getattr(given, name)) for name in LawInput.__dataclass_fields__}
    return _DRIVER.format(**ranges, voltage="output.u_M_V + output.u_T_V")


def driver_of_any_bits() -> str:
    """Every input any 32 bits, NaN and infinities included, step after step."""
    return _DRIVER.format(**dict.fromkeys((*LawInput.__dataclass_fields__, "voltage"), "any_number()"))


def _interval(limits: Range) -> str:
    return f"Frama_C_float_interval({limits[0]:.9g}f, {limits[1]:.9g}f)"
