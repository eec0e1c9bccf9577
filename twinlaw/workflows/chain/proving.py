"""`verify --proofs`: the table of proofs run on one table, and what they add to its verification."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from records.verification import ProofResult, Verification
from twinlaw.cli.console import stage
from verification.proofs import PROOFS, Proof, Subject, run_proof
from verification.proofs.rounding.proof import tighter_bound


def with_proofs(verification: Verification, subject: Subject, proofs: Sequence[Proof] = PROOFS) -> Verification:
    """The verification with a row for each proof, and with the smaller rounding bound where a second one was proved."""
    results = tuple(_run_all(subject, proofs))
    rounding = verification.rounding
    for result in results:
        rounding = tighter_bound(rounding, result)
    roundings = {**verification.roundings, subject.arithmetic: rounding}
    return replace(verification, rounding=rounding, roundings=roundings, proofs=results)


def _run_all(subject: Subject, proofs: Sequence[Proof]) -> Iterator[ProofResult]:
    for proof in proofs:
        with stage(f"proving: {proof.name}"):
            yield run_proof(proof, subject)
