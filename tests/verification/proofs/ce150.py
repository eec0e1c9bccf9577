"""The CE150's law with all that is generated beside it, as the proofs about C are given it."""

from functools import cache

from codegen.law import generate_law
from codegen.protocol_source import protocol_source
from records.protocol import PROTOCOL
from tests.law_tables import ce150_table
from verification.proofs.subject import Subject


@cache
def subject(arithmetic: str = "float32") -> Subject:
    """All that is generated in one of the arithmetics; no image."""
    generated = {**generate_law(ce150_table(), arithmetic), **protocol_source(PROTOCOL)}
    return Subject(ce150_table(), generated, b"", arithmetic=arithmetic)
