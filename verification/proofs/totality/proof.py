"""Saturation is total and the stated ranges hold, for every float32 or every word: decided by bitwuzla, an SMT solver on bits.

No sample is taken: the solver shows that no counterexample exists among all 2^32 (or 2^64) inputs, or names one.
"""

from records.verification import ProofResult
from verification.proofs.subject import Subject
from verification.proofs.totality.questions import Question
from verification.proofs.totality.smt_fixed import fixed_questions
from verification.proofs.totality.smt_text import questions

NAME = "totality and ranges"
_ASKED = {
    "float32": (questions, "float32, NaN and infinities included where they are not excluded"),
    "fixed": (fixed_questions, "word of 32 bits within the stated conditions"),
}


def prove(subject: Subject) -> ProofResult:
    """Every claim holds for all inputs; those that do not are the detail of a failure."""
    law_c = subject.generated["law.c"]
    asks, every = _ASKED[subject.arithmetic]
    asked = list(asks(subject.table, law_c))
    broken = tuple(question.claim for question in asked if not holds(question))
    figures = {"claims": float(len(asked)), "broken": float(len(broken))}
    if broken:
        told = f"{len(broken)} of {len(asked)} claims have a counterexample, first: {broken[0]}"
        return ProofResult(NAME, "failed", told, broken, figures)
    told = f"{len(asked)} claims hold for every {every}"
    return ProofResult(NAME, "proved", told, tuple(question.claim for question in asked), figures)


def holds(question: Question) -> bool:
    """True where no counterexample exists."""
    import bitwuzla  # an optional package

    parser = bitwuzla.Parser(bitwuzla.TermManager(), bitwuzla.Options())
    parser.parse(question.text, False, False)
    return bool(parser.bitwuzla().check_sat() == bitwuzla.Result.UNSAT)
