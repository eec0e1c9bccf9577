"""The static bound on cycles and stack of one control step (verification/static_bound), as a row among the proofs."""

from records.errors import VerificationFailed
from records.verification import ProofResult
from verification.proofs.subject import Subject
from verification.static_bound import kept_bound

NAME = "cycles and stack"


def prove(subject: Subject) -> ProofResult:
    """Cycles without wait states and bytes of stack that no step exceeds; fails where the image cannot be bounded."""
    try:
        bound = kept_bound(subject.elf, "law_step")
    except VerificationFailed as error:
        return ProofResult(NAME, "failed", str(error))
    told = f"law_step takes at most {bound.cycles_bound} cycles and {bound.stack_bytes} bytes of stack"
    figures = {"cycles_bound": float(bound.cycles_bound), "stack_bytes": float(bound.stack_bytes)}
    return ProofResult(NAME, "proved", told, figures=figures)
