"""The kinds of rig that a benchmark can be made of, by name; a name with several plants deals its cases round them."""

from collections.abc import Mapping

from blind.rigs import first, real, second
from blind.rigs.bench import RigKind
from records.errors import BadInput

FIRST = "first"
RIGS: Mapping[str, tuple[RigKind, ...]] = {FIRST: (first.KIND,), "second": (second.KIND,), "real": real.KINDS}


def kinds_of_rig(name: str) -> tuple[RigKind, ...]:
    """The kinds called `name`, one for each of its plants; raises BadInput for one that is not there."""
    if name not in RIGS:
        raise BadInput("kind of rig", "--rig", repr(name), f"one of {', '.join(RIGS)}", "choose one of these")
    return RIGS[name]
