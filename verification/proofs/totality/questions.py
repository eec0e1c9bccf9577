"""What an SMT solver is asked: a claim, and the text whose unsatisfiability proves it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Question:
    """A claim in words, and the text whose unsatisfiability proves it."""

    claim: str
    text: str
