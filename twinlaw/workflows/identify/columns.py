"""Are columns what they are called? As a diagnosis asks it, before parameters are bent to what is not there."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from diagnosis.decide.rows import EARLY, LATE, demand_rows
from diagnosis.decide.wiring import demand_wiring
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from identification.runs.rows import trimmed
from records.log import RunLog
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from twinlaw.cli import console
from twinlaw.workflows.identify.inputs import Inputs, looked_at, read_inputs


def usable_inputs(
    files: Sequence[Path], holdout: Sequence[Path], bound: BoundPlant, trim: tuple[float, float] | None = None
) -> Inputs:
    """Experiments and logs read, cut to the seconds of `trim` where given, looked at, and asked for their columns; raises BadInput."""
    inputs = read_inputs(files, holdout, bound)
    if trim is not None:
        inputs = replace(inputs, logs={name: trimmed(log, *trim) for name, log in inputs.logs.items()})
    inputs = looked_at(inputs, bound)
    with console.stage("asking whether the columns are what they are called"):
        demand_columns(bound, inputs.logs)
    return inputs


def demand_columns(bound: BoundPlant, logs: Mapping[str, RunLog]) -> None:
    """Raise BadInput where the plant as stated follows the logs once a column is turned, exchanged with another, or moved by rows."""
    if not logs:
        return
    library = effect_library(without_effects(bound) if bound.effects else bound)
    case, where = make_case(library, list(logs.values()), stated=bound), ", ".join(logs)
    demand_wiring(case, plain_fit(case), plain_fit, where)
    demand_rows(case, where, (LATE, EARLY))
