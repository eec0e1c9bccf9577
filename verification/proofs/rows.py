"""The table of proofs, in the order in which they run."""

from verification.proofs import cost, rounding
from verification.proofs.subject import Proof
from verification.proofs.tools import GAPPA

PROOFS: tuple[Proof, ...] = (
    Proof(
        rounding.NAME, "what float32 can differ from real numbers in one step", (GAPPA,), rounding.prove, ("float32",)
    ),
    Proof(cost.NAME, "what one control step takes on the target, worst paths of soft float included", (), cost.prove),
)
