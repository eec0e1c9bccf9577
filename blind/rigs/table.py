"""The kinds of rig that a benchmark can be made of, by name."""

from blind.rigs import first, second
from blind.rigs.bench import RigKind
from records.errors import BadInput

FIRST = "first"
RIGS = {FIRST: first.KIND, "second": second.KIND}


def kind_of_rig(name: str) -> RigKind:
    """The kind called `name`; raises BadInput for one that is not there."""
    if name not in RIGS:
        raise BadInput("kind of rig", "--rig", repr(name), f"one of {', '.join(RIGS)}", "choose one of these")
    return RIGS[name]
