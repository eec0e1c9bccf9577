"""Are the columns of logs what they are called, in the rows of their time? What identify, verify and watch ask the plant as stated."""

from collections.abc import Mapping

import numpy as np

from diagnosis.decide.clock import clock_in_doubt
from diagnosis.decide.columns import COLUMNS_ROWS
from diagnosis.decide.rows import EARLY, LATE, demand_rows
from diagnosis.decide.wiring import demand_wiring
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from identification.runs.rows import trimmed
from logcheck.breaks import unbroken
from logcheck.integrity import Integrity, as_read
from records.log import RunLog
from records.reasons import Note
from sim.added_effects import without_effects
from sim.bind import BoundPlant


def demand_columns_of(bound: BoundPlant, log: RunLog, looked: Integrity) -> tuple[Note, ...]:
    """`demand_columns` of one log that was looked at, by its stretches; of one that forbids any conclusion the plant says nothing."""
    if looked.refusals:
        return ()
    (entry,) = looked.logs
    parts = unbroken([as_read(log, entry)], [np.ones(len(log.t_s), bool)], [entry.begins], [entry.name])
    return demand_columns(bound, dict(zip(parts.names, parts.logs, strict=True)))


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
