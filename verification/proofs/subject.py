"""What a proof is about, what a proof is, and how one is run."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from records.table import ControllerTable
from records.verification import ProofResult
from verification.proofs.tools import Tool
from verification.ranges import CE150_MOTION, Motion


@dataclass(frozen=True)
class Subject:
    """One table, the C texts generated from it (file name -> text), the image that holds them, and how far a sampled proof goes.

    `generated` holds law and protocol; `everything` asks a proof that takes samples (mutants) to take all; `seed` draws them.
    """

    table: ControllerTable
    generated: Mapping[str, str]
    elf: bytes
    motion: Motion = CE150_MOTION
    arithmetic: str = "float32"
    everything: bool = False
    seed: int = 1


@dataclass(frozen=True)
class Proof:
    """A row of the table of proofs: its name, what it shows, the tools it needs and the function that runs it."""

    name: str
    shows: str
    tools: tuple[Tool, ...]
    run: Callable[[Subject], ProofResult]


def run_proof(proof: Proof, subject: Subject) -> ProofResult:
    """The result of `proof`; skipped, with what to do, where a tool is absent."""
    for tool in proof.tools:
        if not tool.found():
            return ProofResult(proof.name, "skipped", f"{tool.name} is not installed ({tool.remedy})")
    return proof.run(subject)
