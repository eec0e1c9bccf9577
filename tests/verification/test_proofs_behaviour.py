"""Frama-C EVA on the generated law: silent on the sound one, loud on each of three faults put into it."""

import pytest

from codegen.law import generate_law
from tests.law_tables import ce150_table
from verification.proofs.behaviour import alarms_of, analyses, prove
from verification.proofs.eva_source import comparison_view
from verification.proofs.subject import Subject
from verification.proofs.tools import FRAMA_C

needs_frama_c = pytest.mark.skipif(not FRAMA_C.found(), reason=f"frama-c is not installed ({FRAMA_C.remedy})")

# Each fault, and the analysis that must see it.
FAULTS = {
    "a limit left out": ("? safe : clamp(value, low, high)", "? safe : value", 1),
    "an index beyond the table": ("c[0]", "c[9]", 0),
    "a sign lost in a rank": ("? -magnitude : magnitude", "? -magnitude - 2 : magnitude", 2),
}


def subject(law_c: str | None = None) -> Subject:
    """The CE150 law of the tests, its C replaced where given."""
    generated = generate_law(ce150_table())
    return Subject(ce150_table(), generated if law_c is None else {**generated, "law.c": law_c}, b"")


@needs_frama_c
def test_the_generated_law_raises_no_alarm() -> None:
    result = prove(subject())
    assert result.outcome == "proved", result.figure
    assert len(result.detail) == 3


@needs_frama_c
@pytest.mark.parametrize("fault", FAULTS, ids=list(FAULTS))
def test_a_fault_raises_an_alarm(fault: str) -> None:
    law_c = subject().generated["law.c"]
    good, bad, index = FAULTS[fault]
    assert good in law_c
    assert alarms_of(analyses(subject(law_c.replace(good, bad)))[index])


def test_the_view_keeps_all_but_the_predicates_and_refuses_a_law_without_them() -> None:
    law_c = generate_law(ce150_table())["law.c"]
    view = comparison_view(law_c)
    kept = [line for line in law_c.splitlines() if "static law_number elevation_" in line or "polynomial" in line]
    assert kept
    assert all(line in view for line in kept)
    assert "rank_of" not in view
    with pytest.raises(ValueError, match="is_less 0 times"):
        comparison_view(law_c.replace("static bool is_less", "static bool is_smaller"))
