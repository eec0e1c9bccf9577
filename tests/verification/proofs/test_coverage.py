"""MC/DC of generated C and control path: complete as they are, and a decision that nothing turns is told."""

import subprocess
from pathlib import Path

import pytest

from codegen.law import generate_law
from codegen.protocol_source import protocol_source
from records.protocol import protocol_of
from tests.codegen.test_any_loops import any_table
from tests.law_tables import ce150_table
from tests.soak import SOAK, sampled
from tests.verification.proofs.ce150 import subject
from toolchain.host import run_zig
from verification.proofs.conformance import coverage
from verification.proofs.conformance.coverage import DEVIATIONS, DRIVERS, prove, stimuli_words
from verification.proofs.deviations import Deviation, Finding, judge, load_deviations
from verification.proofs.sources import lay_out
from verification.proofs.subject import Subject
from verification.proofs.tools import CLANG
from verification.stimuli import standard_stimuli

needs_clang = pytest.mark.skipif(not CLANG.found(), reason=f"clang-19 is not installed ({CLANG.remedy})")


@needs_clang
@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_every_decision_is_turned_both_ways_or_justified(arithmetic: str) -> None:
    result = prove(subject(arithmetic))
    assert result.outcome == "proved", "\n".join(result.detail)
    assert result.figures["conditions"] > 40
    assert result.figures["branch_outcomes"] > 250


@needs_clang
def test_a_decision_that_no_input_turns_is_told_with_its_place() -> None:
    good = "if (is_less(value, low)) {"
    law_c = subject().generated["law.c"]
    assert good in law_c
    idle = law_c.replace(good, "if (is_less(value, low) && value < 1.0e38f) {")
    result = prove(Subject(ce150_table(), {**subject().generated, "law.c": idle}, b""))
    assert result.outcome == "failed"
    assert any("never false" in line and "1.0e38f" in line for line in result.detail)
    assert any("condition 2 alone" in line for line in result.detail)


@pytest.mark.parametrize("loops", sampled([3, 1], keep=[3]))
def test_the_drivers_lead_a_law_of_any_loops(loops: int, tmp_path: Path) -> None:
    # Truth: both compile, and in a soak both end and the law's self-test, the driver's verdict, holds.
    table = any_table((3, 2, 1)[:loops], 0, roll_off=False)
    names = lay_out({**generate_law(table), **protocol_source(protocol_of(table.loops))}, tmp_path)
    (tmp_path / "stimuli.bin").write_bytes(stimuli_words(standard_stimuli(table, 200)))
    for driver in DRIVERS:
        (tmp_path / driver).write_text(Path(coverage.__file__).with_name(driver).read_text())
        run_zig(["cc", "-c", "-std=c11", "-Wall", str(tmp_path / driver), "-o", str(tmp_path / "driver.o")], driver)
        if SOAK:
            sources = [str(tmp_path / name) for name in (*names, driver)]
            run_zig(["cc", "-O1", "-std=c11", "-w", *sources, "-o", str(tmp_path / "driver")], driver)
            assert subprocess.run([tmp_path / "driver"], cwd=tmp_path, check=False).returncode == 0, driver


def test_the_stimuli_are_written_as_they_are() -> None:
    stimuli = standard_stimuli(ce150_table(), 1000)
    words = stimuli_words(stimuli)
    expected = sum(3 + s.angles.size + (0 if s.states is None else s.states.size) + s.inputs.size for s in stimuli)
    assert len(words) == 4 * expected


def test_a_justification_that_depends_on_the_table_may_rest() -> None:
    resting = Deviation("never true", "law.c", "another table reaches it", depends_on_table=True)
    assert judge([], [resting]).complaints == ()
    assert judge([Finding("law.c", 1, "never true", "x")], [resting]).complaints == ()
    assert all(len(deviation.reason) > 30 for deviation in load_deviations(DEVIATIONS, "float32"))
