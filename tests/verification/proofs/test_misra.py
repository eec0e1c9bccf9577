"""MISRA findings: all justified, no justification idle; an unjustified line and an idle deviation are told."""

from dataclasses import replace
from pathlib import Path

import pytest

from codegen.law import generate_law
from codegen.protocol_source import protocol_source
from records.loops import Analogue, Pins
from records.protocol import protocol_of
from tests.codegen.test_any_loops import any_table
from tests.law_tables import ce150_table
from tests.soak import sampled
from tests.verification.proofs.ce150 import subject
from verification.proofs import sources
from verification.proofs.conformance.misra import DEVIATIONS, findings_in, prove
from verification.proofs.deviations import Deviation, Finding, judge, load_deviations
from verification.proofs.subject import Subject
from verification.proofs.tools import CPPCHECK

needs_cppcheck = pytest.mark.skipif(not CPPCHECK.found(), reason=f"cppcheck is not installed ({CPPCHECK.remedy})")


@needs_cppcheck
@pytest.mark.parametrize("arithmetic", sampled(["float32", "fixed"], keep=["float32"]))
def test_every_finding_in_the_product_is_justified_and_every_justification_used(arithmetic: str) -> None:
    result = prove(subject(arithmetic))
    assert result.outcome == "proved", "\n".join(result.detail)


@pytest.mark.soak
@needs_cppcheck
def test_the_control_path_of_a_table_with_an_analogue_sensor_alone_is_justified_too() -> None:
    table = any_table((2,), None)
    pins = Pins(None, "PA8", "PB0", Analogue("PA4", -2.0, 2.0))
    table = replace(table, loops=(replace(table.loops[0], pins=pins),))
    generated = {**generate_law(table), **protocol_source(protocol_of(table.loops))}
    result = prove(Subject(table, generated, b""))
    assert result.outcome == "proved", "\n".join(result.detail)


OF_THE_WHOLE = ("2.5", "8.7")  # whether a macro or a function is used elsewhere


@pytest.mark.soak
@needs_cppcheck
def test_every_finding_in_the_fixed_point_law_alone_is_justified(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The control path beside it is the same in float32."""
    monkeypatch.setattr(sources, "CONTROL_DIR", tmp_path)
    law = {name: text for name, text in subject("fixed").generated.items() if name.startswith("law")}
    judgement = judge(findings_in(replace(subject("fixed"), generated=law)), load_deviations(DEVIATIONS, "fixed"))
    assert [finding for finding in judgement.unjustified if finding.rule not in OF_THE_WHOLE] == []
    assert [deviation for deviation in judgement.idle if deviation.arithmetic == "fixed"] == []


BACKWARDS = (
    "void again(int n);\nvoid again(int n)\n{\nback:\n    n--;\n    if (n > 0) {\n        goto back;\n    }\n}\n"
)


@needs_cppcheck
def test_a_jump_backwards_is_found_even_with_nothing_on_the_path(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Rule 15.2: goto shall jump to a label declared later. The addon is a Python program of its own."""
    monkeypatch.setattr(sources, "CONTROL_DIR", tmp_path)  # this file alone
    monkeypatch.setenv("PATH", "/nowhere")
    found = findings_in(Subject(ce150_table(), {"again.c": BACKWARDS}, b""))
    assert any(finding.file == "again.c" and finding.rule == "15.2" for finding in found)


def test_a_finding_beside_the_deviations_and_a_deviation_without_finding_are_complaints() -> None:
    finding = Finding("law.c", 7, "15.1", "    goto out;")
    here = Deviation("15.1", "law.c", "one way out", line="goto out")
    assert judge([finding], [here]).complaints == ()
    assert judge([finding], []).complaints == ("15.1 at law.c:7: goto out;",)
    assert judge([], [here]).complaints == ("unused justification: 15.1 in law.c at /goto out/",)
    assert len(judge([finding], [Deviation("15.1", "link.c", "elsewhere")]).complaints) == 2


def test_every_deviation_says_why_and_none_is_for_an_arithmetic_that_is_not() -> None:
    for arithmetic in ("float32", "fixed"):
        deviations = load_deviations(DEVIATIONS, arithmetic)
        assert all(len(deviation.reason) > 30 for deviation in deviations)
        assert {deviation.arithmetic for deviation in deviations} <= {None, arithmetic}
    assert Path(DEVIATIONS).name == "misra_deviations.toml"
