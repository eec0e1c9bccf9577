"""Are columns what they are called? As a diagnosis asks it, before parameters are bent to what is not there, and where they were."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from diagnosis import decisions
from diagnosis.decide.rows import EARLY, LATE, demand_rows
from diagnosis.decide.wiring import Wiring, demand_wiring, fitted_or_none, wirings
from diagnosis.fit.nominal import gain_over, plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from identification.runs.rows import trimmed
from records.log import RunLog
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from twinlaw.cli import console
from twinlaw.workflows.identify.inputs import Inputs, looked_at, read_inputs

# A reading of the columns that gains so much is named where a fit has failed. Published recordings as they are: 14 at most; with a
# column of quanser_aero or of the pendulum turned: 33 and more.
DOUBT_NATS = 25.0


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
    library, where = effect_library(without_effects(bound) if bound.effects else bound), ", ".join(logs)
    busiest = make_case(library, [where_most_moves(log) for log in logs.values()], stated=bound)
    demand_wiring(busiest, plain_fit(busiest), plain_fit, where)
    demand_rows(make_case(library, list(logs.values()), stated=bound), where, (LATE, EARLY))


def doubted_columns(bound: BoundPlant, logs: Mapping[str, RunLog]) -> str:
    """The reading of the columns by which the plant as stated follows the logs better, as a sentence; empty without one.

    What is not sure enough to refuse the logs says where to look once a fit has failed.
    """
    library = effect_library(without_effects(bound) if bound.effects else bound)
    parts = [replace(where_most_moves(log), extra={}) for log in logs.values()]
    usual = make_case(library, parts, stated=bound)
    fit = fitted_or_none(usual, plain_fit)
    found = []
    for wiring in wirings(usual):
        other = fitted_or_none(make_case(library, [_read_by(wiring, log) for log in parts], stated=bound), plain_fit)
        if fit is not None and other is not None:
            found.append((gain_over(usual, fit, other), wiring.what))
    gain = max((gain for gain, _ in found), default=0.0)
    if gain <= DOUBT_NATS:
        return ""
    alike = ", or ".join(what for own, what in found if gain - own < decisions.WIRING_ALIKE)
    return f"perhaps {alike}: read so, the plant as stated follows the logs {gain:.0f} nats better"


def where_most_moves(log: RunLog) -> RunLog:
    """The rows of the seconds in which the outputs travel most, as many as a diagnosis looks at to doubt the columns."""
    if log.t_s[-1] - log.t_s[0] <= decisions.WIRING_S:
        return log
    y = np.where(np.isfinite(log.y), log.y, np.nanmean(log.y, axis=0, keepdims=True)) if log.y.size else log.y
    spread = np.std(y, axis=0)
    travel = np.abs(np.diff(y, axis=0)) @ np.where(spread > 0.0, 1.0 / np.where(spread > 0.0, spread, 1.0), 0.0)
    gone = np.concatenate([[0.0], np.cumsum(np.nan_to_num(travel))])
    ends = np.searchsorted(log.t_s, log.t_s + decisions.WIRING_S, side="right") - 1
    whole = log.t_s + decisions.WIRING_S <= log.t_s[-1]
    first = int(np.argmax(np.where(whole, gone[ends] - gone, -1.0)))
    return trimmed(log, float(log.t_s[first]), float(log.t_s[ends[first]]))


def _read_by(wiring: Wiring, log: RunLog) -> RunLog:
    u = log.u[:, list(wiring.inputs)] * np.array(wiring.input_signs)
    return replace(log, u=u, y=log.y[:, list(wiring.outputs)] * np.array(wiring.output_signs))
