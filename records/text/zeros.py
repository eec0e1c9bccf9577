"""Zero has no sign: what a number that rounds to it says of its side is its last bit's."""

import re

# A sign that nothing precedes to which it could belong (a name, a number, a power of ten), before a number of zeros alone.
_SIGNED_ZERO = re.compile(r"(?<![\w.)\]/-])[-+](?=0(?:\.0*)?(?:[eE][-+]?\d+)?(?![\w.]))")


def unsigned_zeros(text: str) -> str:
    """`text` with "0.00" in place of each "-0.00" and "+0.00"."""
    return _SIGNED_ZERO.sub("", text)
