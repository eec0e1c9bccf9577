"""Are columns what they are called, and does a sensor's range end? As a diagnosis asks it, before parameters are bent to it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from diagnosis.decide.range_ends import range_ends, within_ranges
from identification.runs.rows import trimmed
from sim.bind import BoundPlant
from twinlaw.cli import console
from twinlaw.workflows.columns import demand_columns
from twinlaw.workflows.identify.inputs import Inputs, doubts_first, looked_at, read_inputs


def usable_inputs(
    files: Sequence[Path], holdout: Sequence[Path], bound: BoundPlant, trim: tuple[float, float] | None = None
) -> Inputs:
    """Experiments and logs read, cut to the seconds of `trim` where given, looked at, and asked for their columns; raises BadInput."""
    inputs = read_inputs(files, holdout, bound)
    if trim is not None:
        inputs = replace(inputs, logs={name: trimmed(log, *trim) for name, log in inputs.logs.items()})
    return asked_for_columns(asked_for_ranges(looked_at(inputs, bound), bound), bound)


def asked_for_ranges(inputs: Inputs, bound: BoundPlant) -> Inputs:
    """The inputs with nothing read where a sensor's range ends, as the logs to fit show, and what is to be said of that."""
    with console.stage("asking whether a sensor's range ends where it stands"):
        logs, names = list(inputs.logs.values()), list(inputs.logs)
        ends = tuple(range_ends(bound, logs, [None] * len(logs), names))
    fitted, kept = (
        {name: within_ranges(log, ends) for name, log in some.items()} for some in (inputs.logs, inputs.holdout)
    )
    notes = tuple(end.note.said for end in ends if end.note.said)
    return replace(inputs, logs=fitted, holdout=kept, notes=(*inputs.notes, *notes))


def asked_for_columns(inputs: Inputs, bound: BoundPlant) -> Inputs:
    """The inputs with what is to be known of their logs' columns; raises BadInput where these are not what they are called."""
    with console.stage("asking whether the columns are what they are called"):
        told = demand_columns(bound, inputs.logs)
    doubt, notes = doubts_first(told)
    return replace(inputs, notes=(*inputs.notes, *notes), doubt="; ".join(filter(None, [inputs.doubt, doubt])))
