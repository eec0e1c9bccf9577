"""The table of proofs, in the order in which they run."""

from verification.proofs import cost
from verification.proofs.behaviour import proof as behaviour
from verification.proofs.conformance import coverage, misra
from verification.proofs.mutation import proof as mutation
from verification.proofs.rounding import proof as rounding
from verification.proofs.subject import Proof
from verification.proofs.tools import BITWUZLA, CLANG, CPPCHECK, FRAMA_C, GAPPA
from verification.proofs.totality import proof as totality

PROOFS: tuple[Proof, ...] = (
    Proof(rounding.NAME, "what rounding can change of real numbers in one step", (GAPPA,), rounding.prove),
    Proof(
        behaviour.NAME,
        "no undefined behaviour, overflow or NaN from any step, for all time",
        (FRAMA_C,),
        behaviour.prove,
    ),
    Proof(
        totality.NAME,
        "limits hold for every bit pattern, coefficients stay within their stated ranges",
        (BITWUZLA,),
        totality.prove,
    ),
    Proof(cost.NAME, "what one control step takes on the target, worst paths of soft float included", (), cost.prove),
    Proof(
        misra.NAME, "rules of MISRA C in generated C and control path, deviations justified", (CPPCHECK,), misra.prove
    ),
    Proof(coverage.NAME, "every decision of the C shown to matter both ways", (CLANG,), coverage.prove),
    Proof(mutation.NAME, "small wrong changes of C, table and twin that the checks notice", (), mutation.prove),
)
