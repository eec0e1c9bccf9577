"""A command, or a call of twinlaw.api, in; what the stages make, as files, reports or records, out; nothing computes here."""

import os
from typing import TYPE_CHECKING, Any

# The matrices here are small, and threads of the linear algebra only stand in the way of the work's own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Results that SymPy remembers of each function, where 1000 are usual: all effects of a plant together ask for some ten thousand, again
# and again, and take half as long again without.
os.environ.setdefault("SYMPY_CACHE_SIZE", "100000")

if TYPE_CHECKING:
    from twinlaw.api import design, design_other, diagnose, fly, generate, identify, load, verify

__all__ = ["design", "design_other", "diagnose", "fly", "generate", "identify", "load", "verify"]


def __getattr__(name: str) -> Any:
    """A function of twinlaw.api, which is read when it is first asked for: most verbs do without most of it."""
    if name not in __all__:
        raise AttributeError(f"module 'twinlaw' has no attribute {name!r}")
    from twinlaw import api

    return getattr(api, name)
