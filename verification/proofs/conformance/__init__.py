"""Conformance of the C text: generated law and control path in, findings of MISRA C and gaps in MC/DC without a justification out."""
