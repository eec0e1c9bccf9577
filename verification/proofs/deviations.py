"""Findings that are justified one by one: a file of deviations, each with its place and its reason, none of them idle."""

import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

from codegen.fixed.constants import FixedLaw, FixedPolynomial, fixed_constants, word_number
from codegen.law_frame import without_vanishing_powers
from records.table import ControllerTable


@dataclass(frozen=True)
class Finding:
    """What a tool says of one line: the rule that it breaks, and the line's text."""

    file: str
    line: int
    rule: str
    text: str

    def __str__(self) -> str:
        return f"{self.rule} at {self.file}:{self.line}: {self.text.strip()}"


@dataclass(frozen=True)
class Deviation:
    """A rule (* for any), the files (shell pattern) and lines (regular expression) where it may be broken, and why.

    `arithmetic` limits it to the law in one arithmetic, `where` to tables that this is said of (`said_of`); one that
    `depends_on_table` may find nothing to cover.
    """

    rule: str
    files: str
    reason: str
    line: str = ""
    arithmetic: str | None = None
    where: str | None = None
    depends_on_table: bool = False

    def covers(self, finding: Finding) -> bool:
        """Whether the finding is of this rule and at this place."""
        here = fnmatch(finding.file, self.files) and re.search(self.line, finding.text)
        return self.rule in (finding.rule, "*") and bool(here)

    def __str__(self) -> str:
        return f"{self.rule} in {self.files}" + (f" at /{self.line}/" if self.line else "")


@dataclass(frozen=True)
class Judgement:
    """Findings without a justification, justifications without a finding, and how many findings there were."""

    unjustified: tuple[Finding, ...]
    idle: tuple[Deviation, ...]
    findings: int

    @property
    def complaints(self) -> tuple[str, ...]:
        """A sentence for each of both; empty when all is justified and nothing idle."""
        idle = (f"unused justification: {deviation}" for deviation in self.idle)
        return (*(str(finding) for finding in self.unjustified), *idle)


def said_of(table: ControllerTable, arithmetic: str) -> frozenset[str]:
    """What a deviation may ask of a table and of the law made of it."""
    feedforwards = [without_vanishing_powers(axis.feedforward_V) for axis in table.axes]
    coefficients = [without_vanishing_powers(p) for axis in table.axes for p in (*axis.q_V_rad, *axis.p)]
    lines = [p for p in (*feedforwards, *coefficients) if len(p) == 2]
    asked = {
        "no schedule": table.schedule is None,
        "no feed-forward": not any(feedforwards),
        "every line goes through zero": not any(line[0] for line in lines),
        "one state": table.order == 1,
        "a difference that no term reads": any(not without_vanishing_powers(axis.p[-1]) for axis in table.axes)
        or any(len(axis.p) <= table.order for axis in table.axes),
        "one state, no difference read": table.order == 1
        and not any(without_vanishing_powers(p) for axis in table.axes for p in axis.p[1:]),
        **(_said_of_words(table) if arithmetic == "fixed" else {}),
    }
    return frozenset(words for words, holds in asked.items() if holds)


def _said_of_words(table: ControllerTable) -> dict[str, bool]:
    law = fixed_constants(table, word_number)
    terms = [term for axis in law.axes for term in axis.terms]
    short = [term.polynomial for term in terms if term.is_short]
    ends = [end for axis in law.axes for end in (axis.reference_min_rad, axis.reference_max_rad)]
    return {
        "no narrow product": not any(term.is_narrow for term in terms),
        "no power by two half products": not any(
            part.products == 2 for form in _polynomials(law) for part in form.powers
        ),
        "no long product": all(term.is_short or term.is_narrow for term in terms),
        "no negative short coefficient": all(form.constant >= 0 and not form.powers for form in short),
        "references within the sensors' range": all(law.angle_min_rad < end < law.angle_max_rad for end in ends),
        "references filtered in half words": all(axis.reference_doublings == 1 for axis in law.axes),
    }


def _polynomials(law: FixedLaw[int]) -> Iterator[FixedPolynomial[int]]:
    for axis in law.axes:
        yield axis.feedforward_V
        yield from (term.polynomial for term in axis.terms)


def load_deviations(path: Path, arithmetic: str, said: frozenset[str] = frozenset()) -> tuple[Deviation, ...]:
    """The deviations of a file that concern the law in `arithmetic`, of a table that this is `said` of."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["deviation"]
    deviations = (Deviation(**entry) for entry in entries)
    return tuple(d for d in deviations if d.arithmetic in (None, arithmetic) and (d.where is None or d.where in said))


def judge(findings: Sequence[Finding], deviations: Sequence[Deviation]) -> Judgement:
    """Hold findings against deviations, both ways."""
    unjustified = tuple(f for f in findings if not any(deviation.covers(f) for deviation in deviations))
    expected = (deviation for deviation in deviations if not deviation.depends_on_table)
    idle = tuple(d for d in expected if not any(d.covers(finding) for finding in findings))
    return Judgement(unjustified, idle, len(findings))
