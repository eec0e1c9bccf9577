"""Names of the generated C behind a prefix, so that two laws live in one image. Pure: texts in, texts out."""

import re
from collections.abc import Mapping

from records.errors import BadInput

LONGEST_PREFIX = (
    20  # with the longest name, law_angle_from_counts_psi, still short of the 63 characters that C11 tells apart
)
_PREFIX = re.compile(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST_PREFIX - 1}}}")
# Functions and types, then macros, enumerators, guards and the digest; a file's name in a comment is none of them.
_LOWER = re.compile(r"\b(?=(?:law|protocol)_\w*\b(?!\.[ch]\b))")
_UPPER = re.compile(r"\b(?=(?:LAW|PROTOCOL)_)")


def prefixed(texts: Mapping[str, str], prefix: str) -> dict[str, str]:
    """The same texts with `prefix` before every name that a linker or another file could see; macros take it in capitals.

    Without one they stay as they are. Raises BadInput for what cannot begin a name in C.
    """
    if prefix and not _PREFIX.fullmatch(prefix):
        expected = f"a letter, then letters, digits or _, {LONGEST_PREFIX} characters at most"
        raise BadInput("prefix", "generate", repr(prefix), expected, "choose one as in --prefix heli1_")
    return {name: _UPPER.sub(prefix.upper(), _LOWER.sub(prefix, text)) for name, text in texts.items()}
