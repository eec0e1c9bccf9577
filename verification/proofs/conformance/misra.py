"""MISRA C:2012 over the generated C and the hardware-free firmware, by cppcheck's addon; each deviation has its reason.

The deviations are in misra_deviations.toml. A finding that none of them covers fails the proof, and so does a deviation that
covers nothing: it would hide what comes later. cppcheck checks the decidable part of the rules; its rule texts cannot be shipped.
"""

import re
import sys
import tempfile
from pathlib import Path

from records.verification import ProofResult
from verification.proofs.deviations import Finding, judge, load_deviations
from verification.proofs.sources import lay_out
from verification.proofs.subject import Subject
from verification.proofs.tools import run_tool

NAME = "MISRA C:2012"
DEVIATIONS = Path(__file__).with_name("misra_deviations.toml")
_OPTIONS = ("--addon=misra", "--enable=style", "--std=c11", "--platform=arm32-wchar_t4", "--quiet")
# The addon is a program of its own, which cppcheck would else look for on the path.
_PYTHON = f"--addon-python={sys.executable}"
_SAID = re.compile(r"^@@(?P<file>[^:]*):(?P<line>\d+):(?P<rule>.*)$", re.MULTILINE)


def prove(subject: Subject) -> ProofResult:
    """Every finding justified, every justification used; otherwise each is told."""
    deviations = load_deviations(DEVIATIONS, subject.arithmetic)
    judgement = judge(findings_in(subject), deviations)
    figures = {"findings": float(judgement.findings), "unjustified": float(len(judgement.unjustified))}
    if judgement.complaints:
        told = f"{len(judgement.complaints)} complaints, first {judgement.complaints[0]}"
        return ProofResult(NAME, "failed", told, judgement.complaints, figures)
    told = f"{judgement.findings} findings, all covered by {len(deviations)} justified deviations"
    return ProofResult(NAME, "proved", told, tuple(f"{d}: {d.reason}" for d in deviations), figures)


def findings_in(subject: Subject) -> list[Finding]:
    """What cppcheck finds in the sources of `subject`."""
    with tempfile.TemporaryDirectory() as work:
        names = lay_out(subject.generated, Path(work))
        template = "--template=@@{file}:{line}:{id}"
        arguments = ["-m", "cppcheck", *_OPTIONS, _PYTHON, template, f"-I{work}", *(f"{work}/{name}" for name in names)]
        said = run_tool(sys.executable, arguments).stderr.replace(f"{work}/", "")
        lines = {path.name: path.read_text(encoding="utf-8").splitlines() for path in Path(work).glob("*.[ch]")}
    found = {(m["file"], int(m["line"]), m["rule"].removeprefix("misra-c2012-")) for m in _SAID.finditer(said)}
    return [Finding(file, line, rule, _text(lines, file, line)) for file, line, rule in sorted(found)]


def _text(lines: dict[str, list[str]], file: str, line: int) -> str:
    return lines[file][line - 1] if file in lines and 0 < line <= len(lines[file]) else ""
