"""Are columns what they are called, and does a sensor's range end? As a diagnosis asks it, before parameters are bent to it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from diagnosis.decide.clock import clock_in_doubt
from diagnosis.decide.columns import COLUMNS_ROWS
from diagnosis.decide.range_ends import range_ends, within_ranges
from diagnosis.decide.rows import EARLY, LATE, demand_rows
from diagnosis.decide.wiring import demand_wiring
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from identification.runs.rows import trimmed
from records.log import RunLog
from records.reasons import Note
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from twinlaw.cli import console
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


def demand_columns(bound: BoundPlant, logs: Mapping[str, RunLog]) -> tuple[Note, ...]:
    """What is to be known of the columns; raises BadInput where the plant as stated follows the logs once a column is turned, exchanged
    with another, or moved by rows."""
    if not logs:
        return ()
    library, where = effect_library(without_effects(bound)), ", ".join(logs)
    whole, busiest = (
        make_case(library, some, stated=bound)
        for some in (list(logs.values()), [where_most_moves(log) for log in logs.values()])
    )
    nominal = plain_fit(whole)
    told = demand_wiring(whole, nominal, plain_fit, where, list(logs), busiest)
    return (*told, *demand_rows(busiest, nominal, where, (LATE, EARLY)), *clock_in_doubt(whole, nominal))


def where_most_moves(log: RunLog) -> RunLog:
    """The rows in which the outputs travel most, as many as a diagnosis looks at to doubt the columns."""
    rows = COLUMNS_ROWS
    if len(log.t_s) <= rows:
        return log
    y = log.y[:, np.isfinite(log.y).any(axis=0)]
    y = np.where(np.isfinite(y), y, np.nanmean(y, axis=0, keepdims=True)) if y.size else y
    spread = np.std(y, axis=0)
    travel = np.abs(np.diff(y, axis=0)) @ np.where(spread > 0.0, 1.0 / np.where(spread > 0.0, spread, 1.0), 0.0)
    gone = np.concatenate([[0.0], np.cumsum(np.nan_to_num(travel))])
    first = int(np.argmax(gone[rows - 1 :] - gone[: 1 - rows]))
    return trimmed(log, float(log.t_s[first]), float(log.t_s[first + rows - 1]))
