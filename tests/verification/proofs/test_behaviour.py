"""Frama-C EVA on the generated law: silent on the sound one, loud on each of three faults put into it."""

import pytest

from codegen.law import generate_law
from tests.law_tables import ce150_table
from tests.soak import sampled
from verification.proofs.behaviour.eva_fixed import decision_view
from verification.proofs.behaviour.eva_source import comparison_view
from verification.proofs.behaviour.proof import alarms_of, analyses, prove
from verification.proofs.subject import Subject
from verification.proofs.tools import FRAMA_C

needs_frama_c = pytest.mark.skipif(not FRAMA_C.found(), reason=f"frama-c is not installed ({FRAMA_C.remedy})")

# Each fault, and the analysis that must see it.
FAULTS = {
    "a limit left out": ("? safe : clamp(value, low, high)", "? safe : value", 1),
    "an index beyond the table": ("c[0]", "c[9]", 0),
    "a sign lost in a rank": ("? -magnitude : magnitude", "? -magnitude - 2 : magnitude", 2),
}


FIXED_FAULTS = {
    "a state that is not brought into its range": ("wrapped(self->e_2_rad, 30u)", "self->e_2_rad", 0),
    "an index beyond the table": ("c[0]", "c[9]", 0),
    "a limit that is not the stated one": ("u_V, limits->u_min_V, limits->u_max_V", "u_V, 0, 2 * limits->u_max_V", 0),
    "a filter without its range": ("target_rad = reference_rad * steps", "target_rad = reference_rad * steps * 8", 0),
    "a shift by too much": ("31u - bits", "32u - bits", 1),
}


def subject(law_c: str | None = None, arithmetic: str = "float32") -> Subject:
    """The CE150 law of the tests, its C replaced where given."""
    generated = generate_law(ce150_table(), arithmetic)
    texts = generated if law_c is None else {**generated, "law.c": law_c}
    return Subject(ce150_table(), texts, b"", arithmetic=arithmetic)


@needs_frama_c
@pytest.mark.parametrize(("arithmetic", "count"), [("float32", 3), ("fixed", 2)])
def test_the_generated_law_raises_no_alarm(arithmetic: str, count: int) -> None:
    result = prove(subject(arithmetic=arithmetic))
    assert result.outcome == "proved", result.figure
    assert len(result.detail) == count


@needs_frama_c
@pytest.mark.parametrize("fault", FAULTS, ids=list(FAULTS))
def test_a_fault_raises_an_alarm(fault: str) -> None:
    law_c = subject().generated["law.c"]
    good, bad, index = FAULTS[fault]
    assert good in law_c
    assert alarms_of(analyses(subject(law_c.replace(good, bad)))[index])


@needs_frama_c
@pytest.mark.parametrize("fault", sampled(FIXED_FAULTS, keep=["an index beyond the table", "a shift by too much"]))
def test_a_fault_in_fixed_point_raises_an_alarm(fault: str) -> None:
    law_c = subject(arithmetic="fixed").generated["law.c"]
    good, bad, index = FIXED_FAULTS[fault]
    assert good in law_c
    assert alarms_of(analyses(subject(law_c.replace(good, bad), "fixed"))[index])


def test_the_view_of_decisions_keeps_all_arithmetic_and_refuses_a_law_without_them() -> None:
    law_c = generate_law(ce150_table(), "fixed")["law.c"]
    view = decision_view(law_c)
    kept = [line for line in law_c.splitlines() if "scaled(" in line or "product(" in line or "wrapped(" in line]
    assert kept
    assert all(line in view for line in kept if "last_V" not in line and "gain" not in line)
    with pytest.raises(ValueError, match="held 0 times"):
        decision_view(law_c.replace("static int32_t held(", "static int32_t kept("))
    with pytest.raises(ValueError, match="v_V 0 times"):
        decision_view(law_c.replace("last_V + masked(", "last_V + (int32_t)("))


def test_the_view_keeps_all_but_the_predicates_and_refuses_a_law_without_them() -> None:
    law_c = generate_law(ce150_table())["law.c"]
    view = comparison_view(law_c)
    kept = [line for line in law_c.splitlines() if "static law_number elevation_" in line or "polynomial" in line]
    assert kept
    assert all(line in view for line in kept)
    assert "rank_of" not in view
    with pytest.raises(ValueError, match="is_less 0 times"):
        comparison_view(law_c.replace("static bool is_less", "static bool is_smaller"))
