"""MC/DC of the generated C and the control path: every outcome of every decision, and every condition alone turning its decision.

clang instruments the sources (-fcoverage-mcdc; source-based coverage of LLVM 19); two drivers lead them through the stimuli of the
equality checks and through the life of a board (drive_law.c, drive_control.c). A decision of one condition has MC/DC when both of
its outcomes were taken: the branches count for these, LLVM's MC/DC records for the others. What cannot be reached is justified
one by one in mcdc_deviations.toml; a justification of something that is reached fails.
"""

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from records.verification import ProofResult
from verification.fixed_stimuli import fixed_stimuli
from verification.proofs.deviations import Finding, judge, load_deviations
from verification.proofs.sources import lay_out
from verification.proofs.subject import Subject
from verification.proofs.tools import run_tool
from verification.stimuli import Stimulus, standard_stimuli

NAME = "MC/DC"
DEVIATIONS = Path(__file__).with_name("mcdc_deviations.toml")
DRIVERS = ("drive_law.c", "drive_control.c")
STEPS = 20_000
_FLAGS = ("-O1", "-std=c11", "-ffp-contract=off", "-fprofile-instr-generate", "-fcoverage-mapping", "-fcoverage-mcdc")
_STIMULI = {"float32": standard_stimuli, "fixed": fixed_stimuli}

Report = Mapping[str, Any]


def prove(subject: Subject) -> ProofResult:
    """Everything covered or justified; otherwise each place is told."""
    try:
        report, lines = measured(subject)
    except ValueError as error:
        return ProofResult(NAME, "failed", str(error))
    deviations = load_deviations(DEVIATIONS, subject.arithmetic)
    judgement = judge(list(_missed(report, lines)), deviations)
    branches, conditions = _count(report, "branches"), _count(report, "mcdc")
    figures = {
        "branch_outcomes": float(branches),
        "conditions": float(conditions),
        "justified": float(judgement.findings - len(judgement.unjustified)),
        "missed": float(len(judgement.unjustified)),
    }
    if judgement.complaints:
        told = f"{len(judgement.complaints)} complaints, first {judgement.complaints[0]}"
        return ProofResult(NAME, "failed", told, judgement.complaints, figures)
    told = (
        f"all of {branches} outcomes and {conditions} conditions, {judgement.findings} of them justified as unreachable"
    )
    return ProofResult(NAME, "proved", told, tuple(f"{d}: {d.reason}" for d in deviations), figures)


def measured(subject: Subject) -> tuple[Report, Mapping[str, list[str]]]:
    """LLVM's coverage of the sources under both drivers, and their lines; raises ValueError where they do not build or run."""
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        names = lay_out({**subject.generated, "protocol.h": with_pins(subject.generated["protocol.h"])}, folder)
        (folder / "stimuli.bin").write_bytes(stimuli_words(_STIMULI[subject.arithmetic](subject.table, STEPS)))
        for driver in DRIVERS:
            _run_driver(folder, driver, names)
        profiles = [driver.replace(".c", ".profraw") for driver in DRIVERS]
        _call("llvm-profdata-19", ["merge", "-sparse", *profiles, "-o", "all.profdata"], folder)
        programs = [driver.removesuffix(".c") for driver in DRIVERS]
        objects = [programs[0], *(f"-object={program}" for program in programs[1:])]
        said = _call("llvm-cov-19", ["export", *objects, "-instr-profile=all.profdata", "-skip-expansions"], folder)
        lines = {path.name: path.read_text(encoding="utf-8").splitlines() for path in folder.glob("*.[ch]")}
    report: Report = json.loads(said)["data"][0]
    return report, lines


def with_pins(protocol_h: str) -> str:
    """The protocol of a board with a sensor and an output for every loop: without them nothing leads into flying."""
    return protocol_h.replace("#define PROTOCOL_HAS_PINS 0", "#define PROTOCOL_HAS_PINS 1")


def stimuli_words(stimuli: Sequence[Stimulus]) -> bytes:
    """The stimuli as drive_law.c reads them."""
    parts = []
    for stimulus in stimuli:
        steps, lanes = stimulus.inputs.shape[:2]
        states = [] if stimulus.states is None else [stimulus.states]
        head = np.array([steps, lanes, len(states)], dtype=np.uint32)
        parts += [head, stimulus.angles, *states, stimulus.inputs]
    return b"".join(np.ascontiguousarray(part, dtype="<u4").tobytes() for part in parts)


def _run_driver(folder: Path, driver: str, names: Sequence[str]) -> None:
    """Compile the sources with a driver, run it, and leave its profile."""
    (folder / driver).write_text(Path(__file__).with_name(driver).read_text(encoding="utf-8"), encoding="utf-8")
    program = driver.removesuffix(".c")
    _call("clang-19", [*_FLAGS, f"-fprofile-instr-generate={program}.profraw", *names, driver, "-o", program], folder)
    _call(str(folder / program), [], folder)


def _call(program: str, arguments: Sequence[str], folder: Path) -> str:
    done = run_tool(program, arguments, folder=folder)
    if done.returncode != 0:
        raise ValueError(f"{Path(program).name}: {' '.join((done.stderr or done.stdout).split())[:200]}")
    return done.stdout


def _missed(report: Report, lines: Mapping[str, list[str]]) -> Iterator[Finding]:
    """What was not covered outside the drivers, by line."""
    for file in report["files"]:
        name = Path(file["filename"]).name
        if name in DRIVERS:
            continue
        for branch in file["branches"]:
            for outcome, times in (("true", branch[4]), ("false", branch[5])):
                if times == 0:
                    yield Finding(name, branch[0], f"never {outcome}", _condition(lines[name], branch))
        for record in file["mcdc_records"]:
            for index, covered in enumerate(record[-1]):
                if not covered:
                    yield Finding(name, record[0], f"condition {index + 1} alone", _condition(lines[name], record))
        # A line that runs through no branch is missed only where its whole function is.
        summary = file["summary"]["functions"]
        if summary["covered"] < summary["count"]:
            yield Finding(name, 1, "function never called", f"{summary['count'] - summary['covered']} of {name}")


def _condition(lines: list[str], region: Sequence[Any]) -> str:
    """The text of a decision, cut out of its line where it is on one."""
    first, from_column, last, to_column = region[:4]
    text = lines[first - 1]
    return str(text[from_column - 1 : to_column - 1] if first == last else text.strip())


def _count(report: Report, what: str) -> int:
    return sum(
        int(file["summary"][what]["count"]) for file in report["files"] if Path(file["filename"]).name not in DRIVERS
    )
