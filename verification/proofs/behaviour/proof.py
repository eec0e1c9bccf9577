"""No undefined behaviour, overflow or NaN for all time: Frama-C EVA on the generated law under a driver that never ends.

EVA encloses every value that any run can reach (abstract interpretation; Frama-C 25 or newer). No alarm is allowed. Law in float32:

    inputs within their declared ranges: every float result finite, outputs and duties within their limits;
    inputs of any bits, NaN and infinities included: no undefined behaviour, outputs and duties still within their limits;
    the predicates on bits, any bits: no undefined behaviour.

Law in fixed point, where every word is a number:

    state and inputs of any words: no overflow, no undefined behaviour, outputs and duties within their limits;
    the decisions by masks, any words: the same.
"""

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from records.verification import ProofResult
from verification.proofs.behaviour.eva_fixed import decision_view, decisions_driver, driver
from verification.proofs.behaviour.eva_source import (
    comparison_view,
    driver_in_range,
    driver_of_any_bits,
    predicates_driver,
)
from verification.proofs.subject import Subject
from verification.proofs.tools import run_tool
from verification.ranges import declared_ranges

NAME = "no undefined behaviour"
_OPTIONS = ("-c11", "-eva", "-eva-precision", "3", "-machdep", "gcc_x86_32")
_TOLD = {
    "float32": "in range all numbers finite, with any bits",
    "fixed": "from any state, with any words nothing overflows,",
}
_SPECIAL_FLOATS = ("-warn-special-float", "none")


@dataclass(frozen=True)
class Analysis:
    """One run of EVA: what of it is analysed, the C files by name, and options of its own."""

    title: str
    files: dict[str, str]
    options: tuple[str, ...] = ()


def prove(subject: Subject) -> ProofResult:
    """No alarm in any analysis; the alarms are the detail of a failure."""
    try:
        found = [(analysis, alarms_of(analysis)) for analysis in analyses(subject)]
    except ValueError as error:
        return ProofResult(NAME, "failed", str(error))
    alarms = tuple(f"{analysis.title}: {alarm}" for analysis, lines in found for alarm in lines)
    if alarms:
        return ProofResult(NAME, "failed", f"{len(alarms)} alarms, first {alarms[0]}", alarms, {"alarms": len(alarms)})
    told = f"no alarm for all time: {_TOLD[subject.arithmetic]} outputs and duties within their limits"
    return ProofResult(NAME, "proved", told, tuple(analysis.title for analysis, _ in found), {"alarms": 0.0})


def analyses(subject: Subject) -> tuple[Analysis, ...]:
    """The analyses of a law, as texts."""
    return _float32_analyses(subject) if subject.arithmetic == "float32" else _fixed_analyses(subject)


def _fixed_analyses(subject: Subject) -> tuple[Analysis, ...]:
    law_h, law_c, loops = subject.generated["law.h"], subject.generated["law.c"], subject.table.loops
    return (
        Analysis(
            "state and inputs of any words", {"law.h": law_h, "law.c": decision_view(law_c), "driver.c": driver(loops)}
        ),
        Analysis("decisions on any words", {"law.h": law_h, "law.c": law_c, "driver.c": decisions_driver(loops)}),
    )


def _float32_analyses(subject: Subject) -> tuple[Analysis, ...]:
    law_h, law_c, loops = subject.generated["law.h"], subject.generated["law.c"], subject.table.loops
    view = {"law.h": law_h, "law.c": comparison_view(law_c)}
    given = declared_ranges(subject.table, subject.motion).given
    return (
        Analysis("inputs in range", {**view, "driver.c": driver_in_range(loops, given)}),
        Analysis("inputs of any bits", {**view, "driver.c": driver_of_any_bits(loops)}, _SPECIAL_FLOATS),
        Analysis(
            "predicates on any bits",
            {"law.h": law_h, "law.c": law_c, "driver.c": predicates_driver(law_c)},
            (*_SPECIAL_FLOATS, "-eva-slevel", "10"),
        ),
    )


def alarms_of(analysis: Analysis) -> list[str]:
    """What EVA says against the program; raises ValueError where it could not analyse it."""
    with tempfile.TemporaryDirectory() as work:
        for name, text in analysis.files.items():
            (Path(work) / name).write_text(text, encoding="utf-8")
        includes_law = '#include "law.c"' in analysis.files["driver.c"]
        sources = [f"{work}/{name}" for name in (("driver.c",) if includes_law else ("law.c", "driver.c"))]
        done = run_tool("frama-c", [*_OPTIONS, f"-cpp-extra-args=-I{work}", *analysis.options, *sources])
        said = done.stdout.replace(f"{work}/", "")
    if done.returncode != 0 or "ANALYSIS SUMMARY" not in said:
        raise ValueError(f"{analysis.title}: EVA stopped: {' '.join((said + done.stderr).split())[-160:]}")
    alarms = re.findall(r"^\[eva:alarm\] (.*?)(?=^\[|\Z)", said, flags=re.MULTILINE | re.DOTALL)
    stated = re.search(r"^ *(\d+) alarms? generated", said, flags=re.MULTILINE)
    if not alarms and (stated is None or stated[1] != "0"):
        raise ValueError(f"{analysis.title}: EVA's summary cannot be read")
    if not alarms and "NON TERMINATING FUNCTION" not in said:
        raise ValueError(f"{analysis.title}: EVA left the loop that never ends")
    return [" ".join(alarm.split()) for alarm in alarms]
