"""Mutation score: how many small wrong changes of C, table and Python twin the equality checks and the self-test notice.

Three groups, each to be noticed to 95 % at least: the generated law.c, the controller table, the Python twin. Without
`everything`, a seeded sample of tables and twins is taken (a mutant of the twin is a run in Python); every mutant of the C runs
always. Survivors are told one by one. Mutants that do what the original does are justified in equivalents.toml and not counted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np

from codegen.fixed.constants import FixedLaw, FixedTerm
from records.verification import ProofResult
from verification.equality import BatchStepper
from verification.host_law import HostLaw
from verification.proofs.deviations import Finding, judge, load_deviations, said_of
from verification.proofs.mutation.judge import stepped, stimuli_of
from verification.proofs.mutation.law import judged_c
from verification.proofs.mutation.mutants_python import mutated_twin, python_mutants
from verification.proofs.mutation.twin import Truth, is_table_noticed, is_twin_noticed, table_mutants, twin_facts
from verification.proofs.subject import Subject

NAME = "mutation score"
EQUIVALENTS = Path(__file__).with_name("equivalents.toml")
LEAST_SCORE = 0.95
SAMPLE = 40
C_STEPS = (4_000, 60_000)
TWIN_STEPS = 10_000
FIRST_STEPS = 12

T = TypeVar("T")


class Placed(Protocol):
    """A mutant, whose text tells it: the function, table, axis or module it is in."""

    @property
    def place(self) -> str: ...


@dataclass(frozen=True)
class Score:
    """What became of one group of mutants."""

    group: str
    noticed: int
    survivors: tuple[str, ...]
    equivalent: int = 0

    @property
    def tried(self) -> int:
        """Mutants that were run."""
        return self.noticed + len(self.survivors)

    @property
    def share(self) -> float:
        """Share noticed; 1 where there were none."""
        return self.noticed / self.tried if self.tried else 1.0

    def __str__(self) -> str:
        equal = f", {self.equivalent} equivalent" if self.equivalent else ""
        return f"{self.group} {self.noticed} of {self.tried} ({100 * self.share:.1f} %{equal})"


def prove(subject: Subject) -> ProofResult:
    """Each group noticed to LEAST_SCORE at least; the survivors are the detail."""
    try:
        scores = (c_score(subject), table_score(subject), twin_score(subject))
    except ValueError as error:
        return ProofResult(NAME, "failed", str(error))
    detail = tuple(f"{score.group}: {survivor}" for score in scores for survivor in score.survivors)
    figures = {f"{score.group}_share": score.share for score in scores}
    figures |= {f"{score.group}_mutants": float(score.tried) for score in scores}
    outcome = "proved" if all(score.share >= LEAST_SCORE for score in scores) else "failed"
    return ProofResult(NAME, outcome, "noticed: " + ", ".join(map(str, scores)), detail, figures)


def c_score(subject: Subject) -> Score:
    """All mutants of law.c."""
    law = {name: text for name, text in subject.generated.items() if name.startswith("law")}
    stimuli = [stimuli_of(subject.table, subject.arithmetic, steps) for steps in C_STEPS]
    judged = judged_c(law, subject.arithmetic, stimuli, loops=subject.table.loops)
    return _score("C", list(judged), subject)


def table_score(subject: Subject) -> Score:
    """Mutants of the table, through the twin that is made from it; one that gives the law the same numbers is none."""
    twin = mutated_twin(subject.arithmetic, None)
    genuine = twin(subject.table)
    truths = _truths(genuine, subject)
    known = _numbers(genuine.law)
    others = [mutant for mutant in table_mutants(subject.table) if _numbers(twin(mutant.table).law) != known]
    mutants = _sampled(others, subject)
    judged = [(mutant, is_table_noticed(twin(mutant.table), truths)) for mutant in mutants]
    return _score("table", judged, subject)


def _numbers(law: Any) -> Any:
    """What a law computes with: in fixed point a constant and its doublings are one number, in whatever halves it is multiplied."""
    if not isinstance(law, FixedLaw):
        return law
    axes = [replace(axis, terms=tuple(_number(term) for term in axis.terms)) for axis in law.axes]
    return replace(law, axes=tuple(axes))


def _number(term: FixedTerm[Any]) -> Any:
    if term.polynomial.powers:
        return term
    return term.coefficient, term.factor, term.sign, term.polynomial.constant * 2**term.doublings, term.excess


def twin_score(subject: Subject) -> Score:
    """Mutants of the twin's own text, against the compiled C."""
    law = {name: text for name, text in subject.generated.items() if name.startswith("law")}
    truths = _truths(HostLaw(law, subject.arithmetic, loops=subject.table.loops), subject)
    table, arithmetic = subject.table, subject.arithmetic
    facts = twin_facts(mutated_twin(arithmetic, None)(table), table)
    mutants = _sampled(list(python_mutants(arithmetic)), subject)
    judged = [(mutant, is_twin_noticed(table, arithmetic, mutant, facts, truths)) for mutant in mutants]
    return _score("twin", judged, subject)


def _truths(law: BatchStepper, subject: Subject) -> tuple[Truth, ...]:
    """What `law` does: first on the first steps of every stimulus, which is enough for most mutants, then on all of them."""
    whole = stimuli_of(subject.table, subject.arithmetic, TWIN_STEPS)
    begun = [replace(stimulus, inputs=stimulus.inputs[:FIRST_STEPS]) for stimulus in whole]
    return tuple(Truth(stimuli, stepped(law, stimuli)) for stimuli in (begun, whole))


def _sampled(mutants: Sequence[T], subject: Subject) -> Sequence[T]:
    """All, or SAMPLE of them drawn by the subject's seed, in their order."""
    if subject.everything or len(mutants) <= SAMPLE:
        return mutants
    chosen = np.random.default_rng(subject.seed).choice(len(mutants), SAMPLE, replace=False)
    return [mutants[int(index)] for index in sorted(chosen)]


def _score(group: str, judged: Sequence[tuple[Placed, bool]], subject: Subject) -> Score:
    """The score of a group, equivalent survivors left out."""
    known = load_deviations(EQUIVALENTS, subject.arithmetic, said_of(subject.table, subject.arithmetic))
    silent = [Finding(mutant.place, 0, group, str(mutant)) for mutant, noticed in judged if not noticed]
    survivors = tuple(finding.text for finding in judge(silent, known).unjustified)
    return Score(group, len(judged) - len(silent), survivors, len(silent) - len(survivors))
